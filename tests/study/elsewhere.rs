//! Scripts for systems that do the runs of a study: what they name, and single jobs of them.
use crate::support::*;
use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Output};

pub const SYSTEMS: [(&str, &str); 3] = [
    ("slurm", "job.slurm"),
    ("parallel", "parallel.sh"),
    ("snakemake", "Snakefile"),
];

/// Runs under these changes, of which some may fail.
fn prepare(folder: &Path, sets: &[Value]) -> Value {
    let values: Vec<Value> = (sets.iter().enumerate())
        .map(|(i, set)| json!({ "label": format!("it's {i}"), "set": set }))
        .collect();
    let variants = json!({ "variants": { "name": "case", "values": values } });
    let study = study(json!([{ "choices": [variants] }]));
    write(folder, "scene.json", &scene());
    write(folder, "study.json", &study);
    study
}

/// `covact study --for`.
pub fn written(folder: &Path, system: &str, more: &[&str]) -> Output {
    let arguments = ["study", "study.json", "-o", "out", "--for", system];
    covact(folder, &[&arguments[..], more].concat())
}

fn job(out: &Path, run: &str) -> Output {
    covact(out, &["job", ".", run])
}

pub fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn json_of(path: &Path) -> Value {
    serde_json::from_str(&read(path)).unwrap()
}

const FAILING: &str = "/solution/newton/max_iterations";

/// The faces that a shell is made of go with the scenes, as tools do: each scene can be run where it lies.
#[test]
fn faces_of_nurbs_shells_lie_beside_the_scenes() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let name = "shells_wrapped.json";
    let mut study: Value =
        serde_json::from_str(&read(&examples.join("studies").join(name))).unwrap();
    study["scene"] = json!(examples.join("scenes/strip_over_cylinder.json"));
    write(folder, "study.json", &study);
    let output = covact(folder, &["study", "study.json", "-o", "out", "--jobs"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let out = folder.join("out");
    let scene = json_of(&out.join("runs/010_NURBS_32_x_1/scene.json"));
    assert_eq!(
        scene["bodies"]["strip"]["nurbs"]["file"],
        "../../files/flat.json"
    );
    let checked = covact(&out, &["check", "runs/010_NURBS_32_x_1/scene.json"]);
    assert_eq!(checked.status.code(), Some(0), "{}", stderr(&checked));
}

#[test]
fn a_job_says_by_name_how_its_run_ended() {
    let folder = tempfile::tempdir().unwrap();
    let failing = json!({ FAILING: 1, "/solution/step/min": 0.5 });
    let mut study = prepare(folder.path(), &[json!({}), failing]);
    let output = written(folder.path(), "slurm", &[]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(
        stderr(&output),
        "2 runs open, 0 done, 0 failed; `sbatch job.slurm` in out does them\n"
    );
    let out = folder.path().join("out");
    let done = job(&out, "001_it_s_0/1");
    assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
    assert!(
        stderr(&done).starts_with("001_it_s_0/1: done, 2 steps, "),
        "{}",
        stderr(&done)
    );
    let failed = job(&out, "002_it_s_1/1");
    assert_eq!(failed.status.code(), Some(4));
    assert!(
        stderr(&failed).contains("error: 002_it_s_1/1: failed: not converged: "),
        "{}",
        stderr(&failed)
    );
    // Neither is done again.
    let accounts = || {
        ["001_it_s_0", "002_it_s_1"].map(|id| read(&out.join(format!("runs/{id}/1/process.json"))))
    };
    let before = accounts();
    let again = job(&out, "001_it_s_0/1");
    assert_eq!(again.status.code(), Some(0));
    assert!(
        stderr(&again).contains("001_it_s_0/1: done (before), 2 steps, "),
        "{}",
        stderr(&again)
    );
    let again = job(&out, "002_it_s_1/1");
    assert_eq!(again.status.code(), Some(4));
    assert!(
        stderr(&again).contains("failed (before): not converged: "),
        "{}",
        stderr(&again)
    );
    assert_eq!(accounts(), before);
    // A script that is written anew names what has failed, and there is none where nothing is open.
    for (system, file) in SYSTEMS {
        let output = written(folder.path(), system, &[]);
        assert_eq!(output.status.code(), Some(4));
        let said = stderr(&output);
        assert!(
            said.contains("error: failed: 002_it_s_1/1: not converged: "),
            "{said}"
        );
        assert!(
            said.contains("0 runs open, 1 done, 1 failed; nothing to do"),
            "{said}"
        );
        assert!(!out.join(file).exists());
    }
    let collect = ["study", "study.json", "-o", "out", "--collect"];
    let output = covact(folder.path(), &collect);
    assert_eq!(output.status.code(), Some(4));
    let said = stderr(&output);
    assert!(
        said.contains("error: failed: 002_it_s_1: not converged: "),
        "{said}"
    );
    assert!(
        said.contains("2 of the runs were not done by this command"),
        "{said}"
    );
    // Where runs may fail, that is no failure of a job.
    study["may_fail"] = json!(true);
    write(folder.path(), "study.json", &study);
    assert_eq!(written(folder.path(), "slurm", &[]).status.code(), Some(0));
    let again = job(&out, "002_it_s_1/1");
    assert_eq!(again.status.code(), Some(0));
    assert!(stderr(&again).contains("error: 002_it_s_1/1: failed (before)"));
}

#[test]
fn jobs_that_cannot_be_done() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let refused = |at: &Path, run: &str, part: &str| {
        let output = job(at, run);
        assert_eq!(output.status.code(), Some(5), "{}", stderr(&output));
        assert!(stderr(&output).contains(part), "{}", stderr(&output));
    };
    refused(path, "a/1", "jobs.json` cannot be read");
    refused(path, "a/1", "`covact study --for` writes it");
    std::fs::write(path.join("jobs.json"), "{}").unwrap();
    refused(path, "a/1", "is no list of runs of this version");
    prepare(path, &[json!({})]);
    written(path, "parallel", &[]);
    let out = path.join("out");
    for run in [
        "001_it_s_0",
        "001_it_s_0/0",
        "001_it_s_0/2",
        "2/1",
        "/1",
        "001_it_s_0/x",
        "",
    ] {
        refused(&out, run, &format!("has no run `{run}`"));
    }
    let mut jobs = json_of(&out.join("jobs.json"));
    jobs["covact"] = json!("0.0.1");
    write(&out, "jobs.json", &jobs);
    refused(&out, "001_it_s_0/1", "is of covact 0.0.1, and this is ");
    // A scene that has changed on the way is no result of the study's.
    written(path, "parallel", &[]);
    let place = out.join("runs/001_it_s_0");
    let mut scene = json_of(&place.join("scene.json"));
    scene["materials"]["steel"]["st_venant_kirchhoff"]["E"] = json!(1);
    write(&place, "scene.json", &scene);
    let output = job(&out, "001_it_s_0/1");
    assert_eq!(output.status.code(), Some(4), "{}", stderr(&output));
    assert!(
        stderr(&output).contains(
            "001_it_s_0/1: left no results: the scene or a file that it names has changed"
        ),
        "{}",
        stderr(&output)
    );
}

/// The names of runs and the program are words of the shell, and of Python.
#[test]
fn scripts_are_right_as_their_languages_have_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    prepare(path, &[json!({}), json!({ FAILING: 12 })]);
    let program = ["--program", "/opt/a tool's {place}/covact"];
    let checks: [(&str, &[&str]); 3] = [
        ("slurm", &["bash", "-n"]),
        ("parallel", &["sh", "-n"]),
        // Rules are no Python, but what stands in them is.
        (
            "snakemake",
            &["grep", "-c", r#"^    "00[12]_it_s_[01]/1",$"#],
        ),
    ];
    for ((system, check), (_, file)) in checks.into_iter().zip(SYSTEMS) {
        let output = written(path, system, &program);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let file = path.join("out").join(file);
        let (command, arguments) = check.split_first().unwrap();
        let checked = Command::new(command).args(arguments).arg(&file).output();
        let checked = checked.unwrap();
        assert!(
            checked.status.success(),
            "{system}: {}\n{}",
            stderr(&checked),
            read(&file)
        );
    }
    let text = read(&path.join("out/Snakefile"));
    let line = text.lines().last().unwrap().trim();
    assert_eq!(
        line,
        r#""'/opt/a tool'\\''s {{place}}/covact' job . {wildcards.id}/{wildcards.repeat}""#
    );
    // A file of the user's own is left alone; a script of the program is written anew.
    for (system, file) in SYSTEMS {
        let file = path.join("out").join(file);
        assert_eq!(written(path, system, &[]).status.code(), Some(0));
        std::fs::write(&file, "# mine\n").unwrap();
        let output = written(path, system, &[]);
        assert_eq!(output.status.code(), Some(5));
        let said = stderr(&output);
        assert!(said.contains("was not written by this program"), "{said}");
        assert_eq!(read(&file), "# mine\n");
    }
    let output = covact(path, &["study", "study.json", "-o", "out", "--for", "lsf"]);
    assert_eq!(output.status.code(), Some(2));
    for others in [["--jobs"], ["--collect"]] {
        assert_eq!(written(path, "slurm", &others).status.code(), Some(2));
    }
}

/// A run that was stopped at its limit goes on when the limit is raised.
#[test]
fn a_job_at_its_limit_goes_on_with_a_higher_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    // Longer than the limit on fast machines, too.
    let step = json!({ "/solution/step": { "initial": 1e-3, "max": 1e-3, "min": 1e-6 } });
    let mut study = prepare(path, &[step]);
    let mut limited = |limit: f64| {
        study["timing"] = json!({ "limit": limit });
        write(path, "study.json", &study);
        let output = written(path, "parallel", &[]);
        (output, job(&path.join("out"), "001_it_s_0/1"))
    };
    let (_, stopped) = limited(0.7);
    assert_eq!(stopped.status.code(), Some(4), "{}", stderr(&stopped));
    assert!(
        stderr(&stopped).contains("failed: stopped at its limit of 0.7 s"),
        "{}",
        stderr(&stopped)
    );
    // The same limit is no reason to try again.
    let (output, again) = limited(0.7);
    assert_eq!(output.status.code(), Some(4));
    assert!(
        stderr(&again).contains("failed (before)"),
        "{}",
        stderr(&again)
    );
    let (output, done) = limited(600.0);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
    let summary = json_of(&path.join("out/runs/001_it_s_0/1/summary.json"));
    assert_eq!(
        (&summary["resumed"], &summary["steps"]),
        (&json!(1), &json!(1000))
    );
    // What is told is the time of both parts.
    let account = json_of(&path.join("out/runs/001_it_s_0/1/process.json"));
    let wall = |of: &Value| of["wall_s"].as_f64().unwrap();
    assert!(
        wall(&account) >= wall(&summary) && wall(&summary) > 0.3,
        "{account} {summary}"
    );
    assert_eq!(account["elsewhere"], json!(true));
}

/// A system asks a job to end before it kills it; two jobs never do the same run at once.
#[cfg(unix)]
#[test]
fn a_job_that_is_asked_to_end_goes_on_later() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    // So many steps that it still runs when it is asked.
    let step = json!({ "/solution/step": { "initial": 2.5e-4, "max": 2.5e-4, "min": 1e-6 } });
    prepare(path, &[step]);
    written(path, "parallel", &[]);
    let (out, run) = (path.join("out"), "001_it_s_0/1");
    let mut first = command(&out, &["job", ".", run])
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let kept = out.join("runs").join(run).join("checkpoint.1.bin");
    let start = std::time::Instant::now();
    while !kept.exists() {
        assert!(start.elapsed().as_secs() < 60);
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    let second = job(&out, run);
    assert_eq!(second.status.code(), Some(5), "{}", stderr(&second));
    assert!(
        stderr(&second).contains("is written to by another run"),
        "{}",
        stderr(&second)
    );
    // It ends at its next step, perhaps before `kill` has come back.
    assert!(first.try_wait().unwrap().is_none());
    let asked = Command::new("kill").arg(first.id().to_string()).status();
    assert!(asked.unwrap().success());
    let first = first.wait_with_output().unwrap();
    assert_eq!(first.status.code(), Some(4), "{}", stderr(&first));
    assert!(
        stderr(&first).contains("error: 001_it_s_0/1: interrupted; called again, it goes on"),
        "{}",
        stderr(&first)
    );
    // It is open, and neither done nor failed.
    let output = written(path, "parallel", &[]);
    assert!(stderr(&output).starts_with("1 runs open, 0 done, 0 failed"));
    let third = job(&out, run);
    assert_eq!(third.status.code(), Some(0), "{}", stderr(&third));
    let summary = json_of(&out.join("runs").join(run).join("summary.json"));
    assert_eq!(
        (&summary["resumed"], &summary["steps"]),
        (&json!(1), &json!(4000))
    );
}
