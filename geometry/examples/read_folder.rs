//! Reads every CAD file of a folder and prints a line for each: faces read and not read, area, closed bodies.
//!
//! `cargo run --release -p covact-geometry --example read_folder -- FOLDER [--notes] [--faces] [--hidden]`

use covact_geometry::PatchSet;
use covact_geometry::io::{ReadOptions, read_path_with};
use covact_geometry::project::Joining;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().ok_or("expected a folder")?;
    let words: Vec<String> = arguments.collect();
    let asked = |option: &str| words.iter().any(|w| w == option);
    let options = ReadOptions {
        hidden: asked("--hidden"),
    };
    let entries = std::fs::read_dir(&folder)?.collect::<Result<Vec<_>, _>>()?;
    let mut paths: Vec<PathBuf> = entries.into_iter().map(|e| e.path()).collect();
    paths.sort();
    println!(
        "{:>6} {:>7} {:>14} {:>6} {:>6}  file",
        "read", "skipped", "area", "parts", "closed"
    );
    for path in paths.iter().filter(|p| p.is_file()) {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let file = match read_path_with(path, &options) {
            Ok(file) => file,
            Err(e) => {
                println!(
                    "{:>6} {:>7} {:>14} {:>6} {:>6}  {name}: {e}",
                    "-", "-", "-", "-", "-"
                );
                continue;
            }
        };
        let (read, skipped) = (file.patches.len(), file.skipped.len());
        let names: Vec<_> = (file.patches.iter())
            .map(|p| (p.entity, p.type_number))
            .collect();
        let patches = file.patches.into_iter().map(|p| p.patch).collect();
        let joining = Joining {
            tolerance: None,
            resolution: file.resolution,
        };
        match PatchSet::join(patches, joining) {
            Ok(set) => {
                let areas = set.areas();
                let area: f64 = areas.iter().sum();
                let closed = set.volumes().iter().flatten().count();
                println!(
                    "{read:>6} {skipped:>7} {area:>14.6} {:>6} {closed:>6}  {name}",
                    set.components().len()
                );
                for ((entity, kind), area) in names.iter().zip(areas).filter(|_| asked("--faces")) {
                    println!("       face {entity} ({kind}): area {area:.6}");
                }
                let report = set.edges();
                println!(
                    "       edges: {} joined, {} free, {} bridged (up to {:.1e}), {} open gaps, {} stacked",
                    report.joints.len(),
                    report.free.len(),
                    report.bridged.len(),
                    report.largest_gap,
                    report.open_gaps.len(),
                    report.stacked.len()
                );
                let gaps = [
                    ("open gap", &report.open_gaps),
                    ("stacked", &report.stacked),
                ];
                for (kind, gap) in gaps.iter().flat_map(|(k, g)| g.iter().map(move |g| (k, g))) {
                    let [a, b] = gap
                        .edges
                        .map(|(patch, edge)| (names[patch as usize].0, edge));
                    println!("       {kind} of {:.2e} between {a:?} and {b:?}", gap.gap);
                }
            }
            Err(e) => println!(
                "{read:>6} {skipped:>7} {:>14} {:>6} {:>6}  {name}: {e}",
                "-", "-", "-"
            ),
        }
        for s in &file.skipped {
            println!(
                "       skipped {} ({}): {}",
                s.entity, s.type_number, s.reason
            );
        }
        for note in file.notes.iter().filter(|_| asked("--notes")) {
            println!("       note: {note}");
        }
    }
    Ok(())
}
