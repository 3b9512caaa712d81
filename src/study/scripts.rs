//! Scripts that have the runs of a study done by another system: an array of Slurm, GNU parallel, Snakemake.
//!
//! Each names the runs that are open as it is written, and calls `covact job` for each of them, which knows by itself what is
//! done, what goes on, and what begins.
use super::folder::quoted;

/// A system that does runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum System {
    /// An array of jobs of Slurm.
    Slurm,
    /// GNU parallel, here or on machines by ssh.
    Parallel,
    /// Snakemake.
    Snakemake,
}

/// What a script is made of.
#[derive(Debug, Clone, Copy)]
pub struct Work<'a> {
    /// The program, as the machines that do the runs know it.
    pub program: &'a str,
    /// Names of the runs that are open (`RUN/REPEAT`).
    pub open: &'a [String],
    /// Threads of a run.
    pub threads: u32,
    /// Seconds after which a run is stopped.
    pub limit: f64,
    /// No run may have another beside it.
    pub one_at_a_time: bool,
    /// The folder of the study has a folder `files`.
    pub files: bool,
}

/// Tasks of an array of Slurm: sites allow 1,000 unless they have raised the number.
const TASKS: usize = 1000;
/// Minutes beyond which no time is asked for: a year.
const MINUTES: f64 = 525_600.0;

impl System {
    /// All of them.
    pub const ALL: [System; 3] = [System::Slurm, System::Parallel, System::Snakemake];

    /// Its name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            System::Slurm => "slurm",
            System::Parallel => "parallel",
            System::Snakemake => "snakemake",
        }
    }

    /// The file that it is given, in the folder of the study.
    pub const fn file(self) -> &'static str {
        match self {
            System::Slurm => "job.slurm",
            System::Parallel => "parallel.sh",
            System::Snakemake => "Snakefile",
        }
    }

    /// What starts the runs, to be called in the folder of the study.
    pub const fn command(self) -> &'static str {
        match self {
            System::Slurm => "sbatch job.slurm",
            System::Parallel => "sh parallel.sh",
            System::Snakemake => "snakemake --cores all --keep-going",
        }
    }

    /// The line by which a script is known as this program's own.
    pub fn mark(self) -> String {
        format!("# Written by `covact study --for {}`", self.name())
    }

    /// The script.
    pub fn script(self, work: &Work) -> String {
        match self {
            System::Slurm => slurm(work),
            System::Parallel => parallel(work),
            System::Snakemake => snakemake(work),
        }
    }
}

/// Whole minutes that a number of runs may take, one after the other, and one more; none where that is no bound.
fn minutes(limit: f64, runs: usize) -> Option<u64> {
    let minutes = (limit * runs as f64 / 60.0).ceil() + 1.0;
    (minutes < MINUTES).then_some(minutes as u64)
}

fn slurm(work: &Work) -> String {
    let runs = work.open.len();
    let tasks = runs.clamp(1, TASKS);
    let each = runs.div_ceil(tasks).max(1);
    let mark = System::Slurm.mark();
    let together = if work.one_at_a_time { "%1" } else { "" };
    let time = minutes(work.limit, each).map_or(String::new(), |m| format!("#SBATCH --time={m}\n"));
    let threads = work.threads.max(1);
    let program = quoted(work.program);
    let names: String = (work.open.iter())
        .map(|name| format!("    {}\n", quoted(name)))
        .collect();
    format!(
        "#!/bin/bash
{mark}, which writes it anew with what is open then.
# In this folder: `sbatch job.slurm`. Options behind `sbatch` take the place of those here: partition, account, time.
#SBATCH --job-name=covact
#SBATCH --array=1-{tasks}{together}
#SBATCH --cpus-per-task={threads}
{time}#SBATCH --output=job_%A_%a.txt
#SBATCH --open-mode=append
#SBATCH --requeue
runs=(
{names})
# A task does every {tasks}th run. The number of the last one that failed is the task's own.
code=0
for ((i = SLURM_ARRAY_TASK_ID - 1; i < ${{#runs[@]}}; i += {tasks})); do
    {program} job . \"${{runs[i]}}\" || code=$?
done
exit $code
"
    )
}

fn parallel(work: &Work) -> String {
    let mark = System::Parallel.mark();
    let program = quoted(work.program);
    let threads = work.threads.max(1);
    let jobs = match (work.one_at_a_time, threads) {
        (true, _) => "1".to_owned(),
        (false, 1) => "100%".to_owned(),
        // A part of the cores; never none.
        (false, n) => format!("{}%", (100 / n).max(1)),
    };
    let files = match work.files {
        true => " --transferfile files",
        false => "",
    };
    let names: String = work.open.iter().map(|name| format!("{name}\n")).collect();
    format!(
        "#!/bin/sh
{mark}, which writes it anew with what is open then.
# `sh parallel.sh` does the runs on this machine, or on those that `machines.txt` beside this file names, a line each:
# `8/user@host` for 8 runs at a time. They see this folder under the same path; COPY=yes copies what a run needs to them
# and its results back. Further arguments go to `parallel`.
cd \"$(dirname \"$0\")\" || exit 5
set -- --jobs \"${{JOBS:-{jobs}}}\" --joblog parallel.log \"$@\"
if [ -f machines.txt ]; then
    set -- --sshloginfile machines.txt \"$@\"
    if [ -n \"${{COPY:-}}\" ]; then
        set -- --workdir ... --cleanup --transferfile jobs.json{files} \\
            --transferfile 'runs/{{//}}/scene.json' --return 'runs/{{}}' \"$@\"
    else
        set -- --workdir \"$PWD\" \"$@\"
    fi
fi
# Ends with the number of runs that failed.
exec parallel \"$@\" {program} job . '{{}}' <<'RUNS'
{names}RUNS
"
    )
}

fn snakemake(work: &Work) -> String {
    let mark = System::Snakemake.mark();
    // Once for the shell, once for Snakemake's braces, once for Python.
    let program = quoted(work.program).replace('{', "{{").replace('}', "}}");
    let shell = python(&format!(
        "{program} job . {{wildcards.id}}/{{wildcards.repeat}}"
    ));
    let threads = match work.one_at_a_time {
        true => "workflow.cores".to_owned(),
        false => work.threads.max(1).to_string(),
    };
    let time = minutes(work.limit, 1).map_or(String::new(), |m| {
        format!("    resources:\n        runtime={m},\n")
    });
    let names: String = (work.open.iter())
        .map(|name| format!("    {},\n", python(name)))
        .collect();
    format!(
        "{mark}, which writes it anew with what is open then.
# In this folder: `snakemake --cores all --keep-going`, with a profile for clusters.
RUNS = [
{names}]


rule all:
    input:
        expand(\"runs/{{run}}.done\", run=RUNS),


# A run that fails has no mark, and keeps its results: it is not done again, but named again.
rule job:
    input:
        \"runs/{{id}}/scene.json\",
    output:
        touch(\"runs/{{id}}/{{repeat}}.done\"),
    threads: {threads}
{time}    shell:
        {shell}
"
    )
}

/// As a string of Python.
fn python(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => out += &format!("\\u{:04x}", u32::from(c)),
            c => out.push(c),
        }
    }
    out + "\""
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(n: usize) -> Vec<String> {
        (1..=n).map(|i| format!("{i:03}_H8/1")).collect()
    }

    fn work(open: &[String]) -> Work<'_> {
        Work {
            program: "covact",
            open,
            threads: 1,
            limit: 3600.0,
            one_at_a_time: false,
            files: false,
        }
    }

    fn assert_parts(text: &str, parts: &[&str]) {
        for part in parts {
            assert!(text.contains(part), "no `{part}` in\n{text}");
        }
    }

    #[test]
    fn a_task_of_slurm_does_one_run_up_to_a_thousand() {
        let open = names(3);
        let text = System::Slurm.script(&work(&open));
        assert!(
            text.starts_with("#!/bin/bash\n# Written by `covact study --for slurm`"),
            "{text}"
        );
        assert_parts(
            &text,
            &[
                "#SBATCH --array=1-3\n",
                "#SBATCH --cpus-per-task=1\n#SBATCH --time=61\n",
                "runs=(\n    001_H8/1\n    002_H8/1\n    003_H8/1\n)\n",
                "i += 3)); do\n    covact job . \"${runs[i]}\" || code=$?\n",
            ],
        );
        // Three runs a task, so three times the time.
        let open = names(2001);
        let text = System::Slurm.script(&work(&open));
        assert_parts(&text, &["--array=1-1000\n", "--time=181\n", "i += 1000)"]);
        // A limit that is none asks for no time.
        let open = names(2);
        let other = Work {
            limit: 1e30,
            threads: 4,
            one_at_a_time: true,
            program: "/opt/my tools/covact",
            ..work(&open)
        };
        let text = System::Slurm.script(&other);
        assert!(!text.contains("--time"), "{text}");
        assert_parts(
            &text,
            &[
                "--array=1-2%1\n",
                "--cpus-per-task=4\n",
                "    '/opt/my tools/covact' job . ",
            ],
        );
    }

    #[test]
    fn parallel_takes_machines_and_copies() {
        let open = names(2);
        let text = System::Parallel.script(&work(&open));
        assert_parts(
            &text,
            &[
                "--jobs \"${JOBS:-100%}\"",
                "--sshloginfile machines.txt",
                "exec parallel \"$@\" covact job . '{}' <<'RUNS'\n001_H8/1\n002_H8/1\nRUNS\n",
            ],
        );
        assert!(!text.contains("--transferfile files"), "{text}");
        let other = Work {
            threads: 3,
            files: true,
            ..work(&open)
        };
        let text = System::Parallel.script(&other);
        assert_parts(
            &text,
            &[
                "${JOBS:-33%}",
                "--transferfile jobs.json --transferfile files ",
            ],
        );
        let alone = Work {
            one_at_a_time: true,
            ..other
        };
        assert_parts(&System::Parallel.script(&alone), &["${JOBS:-1}"]);
    }

    #[test]
    fn snakemake_has_a_mark_for_every_run() {
        let open = names(2);
        let other = Work {
            program: "a \"{tool}\"",
            threads: 2,
            ..work(&open)
        };
        let text = System::Snakemake.script(&other);
        assert!(
            text.starts_with("# Written by `covact study --for snakemake`"),
            "{text}"
        );
        assert_parts(
            &text,
            &[
                "RUNS = [\n    \"001_H8/1\",\n    \"002_H8/1\",\n]\n",
                "    threads: 2\n    resources:\n        runtime=61,\n    shell:\n",
                "\"'a \\\"{{tool}}\\\"' job . {wildcards.id}/{wildcards.repeat}\"",
            ],
        );
        let alone = Work {
            one_at_a_time: true,
            limit: f64::INFINITY,
            ..other
        };
        let text = System::Snakemake.script(&alone);
        assert_parts(&text, &["threads: workflow.cores\n    shell:"]);
    }

    #[test]
    fn texts_are_strings_of_python() {
        assert_eq!(python("a\"b\\c\n"), r#""a\"b\\c\u000a""#);
        assert_eq!(python("ä"), "\"ä\"");
    }
}
