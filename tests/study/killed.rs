//! Studies of two dozen runs that a system is doing when everything is killed, and that go on when they are started again.
//!
//! Slurm, GNU parallel and Snakemake are used where they are there. The script for Slurm is a script of the shell, and is
//! also done as one, with the numbers of the array given by hand.
#![cfg(target_os = "linux")]
use crate::elsewhere::{read, written};
use crate::support::*;
use covact::study::record::Ending;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const RUNS: usize = 24;
const STEPS: usize = 50;

/// Two meshes, twelve depths, in steps that are small enough to be killed between two of them.
fn prepare(folder: &Path) {
    let depths: Vec<String> = (0..12)
        .map(|i| format!("-{}*t", 1.0 + 0.05 * f64::from(i)))
        .collect();
    let depth = json!({ "key": {
        "name": "depth", "at": ["/surfaces/ball/motion/translation/2"], "values": depths
    } });
    let shell = json!({ "shell": { "values": [{ "h8": [3, 3] }, { "h8": [4, 4] }] } });
    let study = study(json!([{ "choices": [shell, depth] }]));
    let mut scene = scene();
    scene["solution"] =
        json!({ "step": { "initial": 1.0 / STEPS as f64, "max": 1.0 / STEPS as f64 } });
    write(folder, "scene.json", &scene);
    write(folder, "study.json", &study);
}

/// Ends every process of a session at once.
fn kill_session(leader: u32) {
    let member = |pid: &str| {
        let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
        // Behind the name, which is in brackets: state, parent, group, session.
        let session = stat
            .rsplit_once(')')?
            .1
            .split_whitespace()
            .nth(3)?
            .to_owned();
        (session == leader.to_string()).then(|| pid.to_owned())
    };
    // Those that are started meanwhile are found the next time.
    loop {
        let names = std::fs::read_dir("/proc").unwrap().flatten();
        let names = names.filter_map(|e| e.file_name().into_string().ok());
        let alive = |pid: &String| {
            let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
            !stat
                .rsplit_once(')')
                .is_none_or(|(_, s)| s.trim_start().starts_with('Z'))
        };
        let members: Vec<String> = names.filter_map(|n| member(&n)).filter(alive).collect();
        if members.is_empty() {
            return;
        }
        // Stopped by their numbers.
        let _ = Command::new("kill")
            .arg("-9")
            .args(&members)
            .stderr(Stdio::null())
            .status();
        std::thread::sleep(Duration::from_millis(5));
    }
}

struct Place {
    folder: tempfile::TempDir,
}

impl Place {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        prepare(folder.path());
        Place { folder }
    }

    fn out(&self) -> PathBuf {
        self.folder.path().join("out")
    }

    fn write(&self, system: &str) {
        let output = written(
            self.folder.path(),
            system,
            &["--program", env!("CARGO_BIN_EXE_covact")],
        );
        assert!(output.status.success(), "{}", stderr(&output));
    }

    /// Folders of results.
    fn results(&self) -> Vec<PathBuf> {
        let runs = std::fs::read_dir(self.out().join("runs")).unwrap();
        let mut all: Vec<PathBuf> = runs.map(|e| e.unwrap().path().join("1")).collect();
        all.sort();
        assert_eq!(all.len(), RUNS);
        all
    }

    fn accounts(&self) -> Vec<(PathBuf, String)> {
        let paths = self.results().into_iter().map(|r| r.join("process.json"));
        paths
            .filter(|p| p.exists())
            .map(|p| (p.clone(), read(&p)))
            .collect()
    }

    /// Folders with checkpoints.
    fn under_way(&self) -> Vec<PathBuf> {
        let kept = |r: &PathBuf| (0..3).any(|i| r.join(format!("checkpoint.{i}.bin")).exists());
        self.results().into_iter().filter(kept).collect()
    }

    /// Starts a command in a session of its own, and kills that with some runs done and others under way.
    fn kill_in_the_midst(&self, command: &[&str], stop: impl FnOnce()) {
        let said = std::fs::File::create(self.folder.path().join("said.txt")).unwrap();
        let mut child = Command::new("setsid")
            .args(command)
            .current_dir(self.out())
            .stdin(Stdio::null())
            .stdout(said.try_clone().unwrap())
            .stderr(said)
            .spawn()
            .unwrap();
        let start = Instant::now();
        loop {
            // So early that none can have ended before it is killed.
            let early = |results: &PathBuf| {
                let table = std::fs::read_to_string(results.join("history.csv"));
                (3..STEPS / 2).contains(&table.unwrap_or_default().lines().count())
            };
            let far = self.accounts().len() >= 5 && self.under_way().iter().any(early);
            if far {
                break;
            }
            assert!(
                start.elapsed() < Duration::from_secs(240),
                "{}",
                read(&self.folder.path().join("said.txt"))
            );
            std::thread::sleep(Duration::from_millis(3));
        }
        stop();
        kill_session(child.id());
        let _ = child.wait();
    }

    /// Kills a command in the midst of the study, calls it again, and compares all with the study that was done at once.
    fn killed_and_resumed(&self, command: &[&str]) {
        self.kill_in_the_midst(command, || {});
        let (before, under_way) = (self.accounts(), self.under_way());
        assert!((5..RUNS).contains(&before.len()), "{}", before.len());
        let output = Command::new(command[0])
            .args(&command[1..])
            .current_dir(self.out())
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        self.compare(&before, &under_way);
    }

    /// What was done is as it was, what was under way has gone on, and the study is the same as one that was done at once.
    fn compare(&self, before: &[(PathBuf, String)], under_way: &[PathBuf]) {
        for (path, account) in before {
            assert_eq!(read(path), *account, "{}", path.display());
        }
        let resumed = |results: &Path| -> u64 {
            let text = read(&results.join("summary.json"));
            let summary: Value = serde_json::from_str(&text).unwrap();
            summary["resumed"].as_u64().unwrap()
        };
        let done: Vec<&Path> = before.iter().filter_map(|(p, _)| p.parent()).collect();
        // One that was killed while it wrote the last word of it may have been done.
        let cut: Vec<&PathBuf> = under_way
            .iter()
            .filter(|r| !done.contains(&r.as_path()))
            .collect();
        assert!(cut.iter().any(|r| resumed(r) == 1), "{cut:?}");
        for results in self.results().iter().filter(|r| !under_way.contains(r)) {
            assert_eq!(resumed(results), 0, "{}", results.display());
        }
        let folder = self.folder.path();
        let collect = ["study", "study.json", "-o", "out", "--collect"];
        let collected = covact(folder, &collect);
        assert_eq!(collected.status.code(), Some(0), "{}", stderr(&collected));
        let direct = covact(folder, &["study", "study.json", "-o", "direct", "--quiet"]);
        assert_eq!(direct.status.code(), Some(0), "{}", stderr(&direct));
        let (direct, collected) = (record(&folder.join("direct")), record(&self.out()));
        assert_eq!(direct.runs.len(), RUNS);
        let mut forces = Vec::new();
        for (a, b) in direct.runs.iter().zip(&collected.runs) {
            assert_eq!((&a.id, &a.ending), (&b.id, &Ending::Done));
            assert_eq!((&a.measured, &a.steps_taken), (&b.measured, &b.steps_taken));
            forces.push(a.measured[0].value.unwrap());
        }
        assert!(forces.iter().all(|f| *f < -1.0), "{forces:?}");
        forces.dedup();
        assert_eq!(forces.len(), RUNS);
    }
}

fn is_there(command: &str) -> bool {
    let told = Command::new(command).arg("--version").output();
    let there = told.is_ok_and(|o| o.status.success());
    if !there {
        eprintln!("no {command}: it is not tried");
    }
    there
}

#[test]
fn the_array_of_slurm_as_a_script_of_the_shell() {
    let place = Place::new();
    place.write("slurm");
    let array = format!("seq {RUNS} | xargs -P 2 -I N env SLURM_ARRAY_TASK_ID=N bash job.slurm");
    place.killed_and_resumed(&["sh", "-c", &array]);
}

#[test]
fn gnu_parallel() {
    if !is_there("parallel") {
        return;
    }
    let place = Place::new();
    place.write("parallel");
    place.killed_and_resumed(&["sh", "parallel.sh"]);
    // Another script has nothing to do.
    let output = written(place.folder.path(), "parallel", &[]);
    assert!(stderr(&output).contains("0 runs open, 24 done, 0 failed; nothing to do"));
}

#[test]
fn snakemake() {
    if !is_there("snakemake") {
        return;
    }
    let place = Place::new();
    place.write("snakemake");
    // A lock is left by what was killed, and runs that were under way are known as such.
    let command = "snakemake --unlock --quiet all; snakemake --cores 2 --keep-going --rerun-incomplete --quiet all";
    place.killed_and_resumed(&["sh", "-c", command]);
}

/// Where a controller answers: jobs are cancelled and sent again.
#[test]
fn slurm() {
    let answers = is_there("sbatch")
        && Command::new("sinfo")
            .arg("--noheader")
            .output()
            .is_ok_and(|o| o.status.success());
    if !answers {
        eprintln!("no Slurm that answers: it is not tried");
        return;
    }
    let place = Place::new();
    place.write("slurm");
    place.kill_in_the_midst(&["sbatch", "--wait", "job.slurm"], || {
        let said = read(&place.folder.path().join("said.txt"));
        let job = said.split_whitespace().last().unwrap().to_owned();
        let cancel = Command::new("scancel")
            .args(["--signal=KILL", "--full", &job])
            .status();
        assert!(cancel.unwrap().success());
        let cancel = Command::new("scancel").arg(&job).status();
        assert!(cancel.unwrap().success());
        let start = Instant::now();
        let left = || {
            Command::new("squeue")
                .args(["--noheader", "--job", &job])
                .output()
                .unwrap()
        };
        while !left().stdout.is_empty() {
            assert!(start.elapsed() < Duration::from_secs(120));
            std::thread::sleep(Duration::from_millis(200));
        }
    });
    let (before, under_way) = (place.accounts(), place.under_way());
    // Only what is open is sent again.
    place.write("slurm");
    let array = format!("#SBATCH --array=1-{}\n", RUNS - before.len());
    assert!(
        read(&place.out().join("job.slurm")).contains(&array),
        "{array}"
    );
    let output = Command::new("sbatch")
        .args(["--wait", "job.slurm"])
        .current_dir(place.out())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    place.compare(&before, &under_way);
}
