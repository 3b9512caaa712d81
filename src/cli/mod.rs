//! The command line. Nothing else in the library prints.
mod cad;
mod check;
mod convert;
mod gauntlet;
mod inspect;
mod interrupt;
mod job;
mod log;
mod new;
mod plan;
mod progress;
mod project;
mod reference;
mod report;
mod run;
mod soak;
mod study;
mod text;
mod view;
mod without;

pub use reference::reference;

use clap::{Args, CommandFactory, Parser, Subcommand};
use std::ffi::OsString;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// The numbers of [`Exit`](crate::run::Exit); 0 is success.
pub(crate) mod exit {
    use crate::run::Exit;

    pub const BUG: u8 = Exit::Bug.code();
    pub const USAGE: u8 = Exit::Usage.code();
    pub const SCENE: u8 = Exit::Scene.code();
    pub const NOT_CONVERGED: u8 = Exit::NotConverged.code();
    pub const IO: u8 = Exit::Io.code();
    pub const KILLED: u8 = Exit::Killed.code();

    /// All of them in one sentence.
    pub fn sentence() -> String {
        let each = Exit::ALL.map(|exit| format!("{} {}", exit.code(), exit.short()));
        format!("Exit codes: {}.", each.join(", "))
    }
}

/// Contact between finite-element shells and CAD surfaces.
#[derive(Debug, Parser)]
#[command(
    name = "covact",
    version,
    after_help = exit::sentence()
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Solve a scene
    Run(RunArgs),
    /// Read and check everything a scene names; solve nothing
    Check(CheckArgs),
    /// Every effect that the program has: on or off in a scene, why, and what it costs; solve nothing
    Plan(CheckArgs),
    /// Make the page of a run again, from the files in its folder
    View(ViewArgs),
    /// Make a page with two runs side by side
    Compare(CompareArgs),
    /// Show what is in a CAD file
    Inspect(InspectArgs),
    /// Closest points of a CAD file to the points of a list
    Project(ProjectArgs),
    /// Write the surfaces of a CAD file, with their trims, as JSON that loses nothing
    Convert(ConvertArgs),
    /// Run hard cases with known answers, and show how each came out
    Gauntlet(GauntletArgs),
    /// Run random scenes, each in a process of its own, and audit what they report
    Soak(SoakArgs),
    /// Run a scene over a grid of choices, and compare errors and times
    Study(StudyArgs),
    /// Do one run of a study for a script of `covact study --for`: unless it has ended, from where it was cut short
    Job(JobArgs),
    /// Print the JSON schema of scenes
    Schema(SchemaArgs),
    /// Write a scene to start from
    New(NewArgs),
    /// Print the completions of a shell, to be read by it
    Completions(CompletionsArgs),
    /// Write the manual pages of the program and of its commands
    Man(ManArgs),
}

#[derive(Debug, Args)]
struct RunArgs {
    /// Scene file (JSON)
    scene: PathBuf,
    /// Folder for the results
    #[arg(short, long, value_name = "FOLDER")]
    out: PathBuf,
    /// Go on with a run that was cut short, from its last accepted step
    #[arg(long, conflicts_with = "force")]
    resume: bool,
    /// Replace the run that FOLDER holds; files of others stay
    #[arg(long)]
    force: bool,
    #[arg(long, value_name = "EFFECT", conflicts_with = "off", help = without::help())]
    without: Vec<String>,
    /// Run only the what-if: the scene without this effect, into FOLDER
    #[arg(long, value_name = "EFFECT", hide = true)]
    off: Option<String>,
    /// Print one JSON object per event and line
    #[arg(long, conflicts_with = "quiet")]
    json: bool,
    /// Print errors only
    #[arg(short, long)]
    quiet: bool,
    /// Print every iteration, where the output is no terminal too
    #[arg(short, long, conflicts_with_all = ["quiet", "json"])]
    verbose: bool,
    /// Threads; 0: as the scene says, or what the machine has
    #[arg(long, value_name = "N", default_value_t = 0)]
    threads: usize,
    /// Leave out `report.html`
    #[arg(long)]
    no_report: bool,
}

#[derive(Debug, Args)]
struct ViewArgs {
    /// Folder with the results of a run; `report.html` is written there
    folder: PathBuf,
}

#[derive(Debug, Args)]
struct CompareArgs {
    /// Folder with the results of a run
    first: PathBuf,
    /// Folder with the results of another run
    second: PathBuf,
    /// Page to write
    #[arg(short, long, value_name = "FILE", default_value = "compare.html")]
    out: PathBuf,
}

#[derive(Debug, Args)]
struct CheckArgs {
    /// Scene file (JSON)
    scene: PathBuf,
    /// Print the findings as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
struct InspectArgs {
    /// STEP or IGES file, JSON of Kratos, geomdl or `covact convert`, or STL
    file: PathBuf,
    /// Print the findings as JSON
    #[arg(long)]
    json: bool,
    /// Read what the CAD system hides (blanked entities of IGES, invisible items and layers of STEP) as well
    #[arg(long)]
    hidden: bool,
    /// List what the file holds, without areas, curvatures, edges and volumes: for large files
    #[arg(long)]
    brief: bool,
}

#[derive(Debug, Args)]
struct ProjectArgs {
    /// STEP or IGES file, or JSON of Kratos, geomdl or `covact convert`
    file: PathBuf,
    /// Text file with `x y z` in every line, separated by blanks or commas; what follows a # is a comment; - reads
    /// the standard input
    points: PathBuf,
    /// Table to write (CSV); - is the standard output
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    out: PathBuf,
    /// Write one JSON object per point and line instead
    #[arg(long)]
    json: bool,
    /// Look no farther than this length
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    reach: Option<f64>,
    /// Length unit of the points and of what is written (mm, m, in, ...), to which the CAD file is converted; else that
    /// of the CAD file
    #[arg(long, value_name = "UNIT")]
    unit: Option<String>,
    /// Threads; 0: what the machine has
    #[arg(long, value_name = "N", default_value_t = 0)]
    threads: usize,
}

#[derive(Debug, Args)]
struct ConvertArgs {
    /// STEP or IGES file, or JSON of Kratos or geomdl
    file: PathBuf,
    /// File to write: IGES faces if it ends in .igs or .iges, triangles if in .stl, else JSON; - is the standard output
    #[arg(short, long, value_name = "FILE")]
    out: PathBuf,
    /// Length unit to convert to (mm, m, in, ...); else that of the CAD file, and every number stays as it is
    #[arg(long, value_name = "UNIT")]
    unit: Option<String>,
    /// Largest distance of triangles from the surface; a two-thousandth of its size by default
    #[arg(long, value_name = "LENGTH")]
    tolerance: Option<f64>,
}

#[derive(Debug, Args)]
struct GauntletArgs {
    /// Cases, `GROUP/NAME`, or whole groups; default: all
    #[arg(value_name = "CASE")]
    cases: Vec<String>,
    /// List the cases, run nothing
    #[arg(long)]
    list: bool,
    /// Print the verdicts as JSON
    #[arg(long, conflicts_with = "markdown")]
    json: bool,
    /// Print a Markdown table
    #[arg(long)]
    markdown: bool,
    /// Threads of each run; cases run side by side as well
    #[arg(long, value_name = "N", default_value_t = 1)]
    threads: u32,
}

#[derive(Debug, Args)]
struct SoakArgs {
    /// First seed; a seed is a scene
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Scenes
    #[arg(long, value_name = "N", default_value_t = 100)]
    count: u64,
    /// Seconds that a scene may take
    #[arg(long, value_name = "SECONDS", default_value_t = 300)]
    limit: u64,
    /// Repeat what reaches its end in half of the steps and under ten times the penalty, and on a finer mesh where a warning is of the mesh, and compare forces
    #[arg(long)]
    repeat: bool,
    /// Folder for scenes and results, a folder per seed
    #[arg(short, long, value_name = "FOLDER")]
    out: PathBuf,
    /// Print the account as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
struct StudyArgs {
    /// Study file (JSON)
    study: PathBuf,
    /// Folder for scenes, results and the report; a study that was cut short goes on
    #[arg(short, long, value_name = "FOLDER")]
    out: PathBuf,
    /// Run nothing; write the scenes and `jobs.txt`, a command a line, for other machines
    #[arg(long, group = "elsewhere")]
    jobs: bool,
    /// Run nothing; write the scenes and a script that has the runs done that are open: `job.slurm`, `parallel.sh` or
    /// `Snakefile`
    #[arg(long = "for", value_name = "SYSTEM", group = "elsewhere")]
    system: Option<study::Target>,
    /// The program's name in `jobs.txt` or in the script
    #[arg(long, value_name = "NAME", requires = "elsewhere")]
    program: Option<String>,
    /// Run nothing; take the results that are there
    #[arg(long, conflicts_with = "elsewhere")]
    collect: bool,
    /// Print one JSON object per event and line
    #[arg(long, conflicts_with = "quiet")]
    json: bool,
    /// Print errors and warnings only
    #[arg(short, long)]
    quiet: bool,
}

#[derive(Debug, Args)]
struct JobArgs {
    /// Folder of the study
    folder: PathBuf,
    /// The run, `RUN/REPEAT`, of those that `jobs.json` lists
    run: String,
}

#[derive(Debug, Args)]
struct SchemaArgs {
    /// That of studies
    #[arg(long)]
    study: bool,
}

#[derive(Debug, Args)]
struct NewArgs {
    /// Name of the scene; `NAME.json` is written
    name: String,
    /// What the scene is about
    #[arg(short, long, value_name = "TEMPLATE", default_value = "press")]
    template: new::Template,
}

#[derive(Debug, Args)]
struct CompletionsArgs {
    /// Shell that is to complete commands
    shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
struct ManArgs {
    /// Folder for the pages, made where it is missing; `man` finds them in `man1` of a folder of its path
    #[arg(short, long, value_name = "FOLDER")]
    out: PathBuf,
}

/// Writes the manual pages.
fn man(args: &ManArgs) -> u8 {
    let written = std::fs::create_dir_all(&args.out)
        .and_then(|()| clap_mangen::generate_to(Cli::command(), &args.out));
    match written {
        Ok(()) => 0,
        Err(e) => {
            report::error(&format!(
                "cannot write manual pages to {}: {e}",
                args.out.display()
            ));
            exit::IO
        }
    }
}

/// Prints the completions of a shell.
fn completions(args: &CompletionsArgs) -> u8 {
    let mut text = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "covact", &mut text);
    print(&String::from_utf8_lossy(&text))
}

/// The program that runs of a study or a soak are started with.
static PROGRAM: OnceLock<PathBuf> = OnceLock::new();

/// The program that this one calls for parts of its work: itself.
fn program() -> std::io::Result<PathBuf> {
    match PROGRAM.get() {
        Some(program) => Ok(program.clone()),
        None => std::env::current_exe(),
    }
}

/// Runs the program with the arguments of the process.
pub fn main() -> ExitCode {
    ExitCode::from(main_of(std::env::args_os(), None))
}

/// Runs the program with these arguments, of which the first is its name. `called` is the program that does the same with
/// its own arguments, where that is not the one that runs. Returns the exit code.
pub fn main_of(arguments: impl Iterator<Item = OsString>, called: Option<PathBuf>) -> u8 {
    if let Some(called) = called {
        // Set once: another call has the same.
        let _ = PROGRAM.set(called);
    }
    std::panic::set_hook(Box::new(report::panic));
    if !interrupt::survive_large_files() {
        report::warning("a file that outgrows the limit on its size will end the program");
    }
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(e) => {
            // Prints help and version to standard output, everything else to standard error.
            let written = e.print();
            let code = if e.use_stderr() { exit::USAGE } else { 0 };
            return if written.is_ok() { code } else { exit::IO };
        }
    };
    let result = std::panic::catch_unwind(move || match cli.command {
        Command::Run(args) => run::run(&args),
        Command::Check(args) => check::check(&args),
        Command::Plan(args) => plan::plan(&args),
        Command::View(args) => view::view(&args),
        Command::Compare(args) => view::compare(&args),
        Command::Inspect(args) => inspect::inspect(&args),
        Command::Project(args) => project::project(&args),
        Command::Convert(args) => convert::convert(&args),
        Command::Gauntlet(args) => gauntlet::gauntlet(&args),
        Command::Soak(args) => soak::soak(&args),
        Command::Study(args) => study::study(&args),
        Command::Job(args) => job::job(&args),
        Command::Schema(args) => print(&match args.study {
            true => crate::study::schema(),
            false => crate::scene::schema(),
        }),
        Command::New(args) => new::new(&args),
        Command::Completions(args) => completions(&args),
        Command::Man(args) => man(&args),
    });
    // The hook has told about the panic.
    let code = result.unwrap_or(exit::BUG);
    match code {
        0 if PRINTING_FAILED.load(Ordering::Relaxed) => exit::IO,
        code => code,
    }
}

/// Whether something could not be printed, which has been told then.
static PRINTING_FAILED: AtomicBool = AtomicBool::new(false);

/// Prints to standard output and returns the exit code. A reader that goes away (`covact schema | head`) is no error. Whoever
/// goes on after a failure need not keep the code: the program ends with it unless it has a worse one.
fn print(text: &str) -> u8 {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => 0,
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => 0,
        Err(e) => {
            // Of many lines that cannot be printed, one error is enough.
            if !PRINTING_FAILED.swap(true, Ordering::Relaxed) {
                report::error(&format!("cannot write to the standard output: {e}"));
            }
            exit::IO
        }
    }
}

/// Prints data as one JSON document.
fn print_json<T: serde::Serialize>(data: &T) -> u8 {
    match serde_json::to_string_pretty(data) {
        Ok(text) => print(&(text + "\n")),
        Err(e) => {
            report::error(&format!("cannot write the findings as JSON: {e}"));
            exit::BUG
        }
    }
}
