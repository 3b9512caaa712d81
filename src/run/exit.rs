//! The codes that the program ends with.

/// How the program ends, as the system sees it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Exit {
    /// What was asked for is done.
    Done = 0,
    /// A fault of the program itself.
    Bug = 1,
    /// The command line is wrong, or the folder that it names for results is taken.
    Usage = 2,
    /// The scene, or a file it names, is wrong.
    Scene = 3,
    /// The run did not reach its end; what was computed is kept.
    NotConverged = 4,
    /// Reading or writing failed.
    Io = 5,
    /// The user interrupted the program twice; 130 is what shells report for this signal.
    Killed = 130,
}

impl Exit {
    /// All of them, ascending.
    pub const ALL: [Exit; 7] = [
        Exit::Done,
        Exit::Bug,
        Exit::Usage,
        Exit::Scene,
        Exit::NotConverged,
        Exit::Io,
        Exit::Killed,
    ];

    /// The number.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// What it means, in a few words.
    pub const fn short(self) -> &'static str {
        match self {
            Exit::Done => "done",
            Exit::Bug => "a bug of covact",
            Exit::Usage => "wrong usage or a folder that is taken",
            Exit::Scene => "the scene or a file it names is wrong",
            Exit::NotConverged => "not converged or interrupted (what was computed is kept)",
            Exit::Io => "reading or writing failed",
            Exit::Killed => "interrupted twice",
        }
    }

    /// What it means, with all cases.
    pub const fn meaning(self) -> &'static str {
        match self {
            Exit::Done => "done",
            Exit::Bug => "a bug of covact",
            Exit::Usage => {
                "wrong usage, or a folder for results that holds a run, is in use, or has files of others in their places"
            }
            Exit::Scene => {
                "the scene, or a file it names, is wrong, or not the one to be continued (file, line, column, what was \
                 expected, the nearest valid name)"
            }
            Exit::NotConverged => {
                "not converged, interrupted, or a contact that never touched (told only: a body's contact with itself, \
                 contacts of which both sides have touched in others, surfaces at rest in front of a slave that has \
                 touched elsewhere, which may be stops, and surfaces that move with one that has touched, as parts of a \
                 tool); what was computed is kept"
            }
            Exit::Io => {
                "reading or writing failed, or there is no run to continue; what was written before is intact"
            }
            Exit::Killed => {
                "interrupted a second time (Ctrl-C): ended at once; what accepted steps have written is kept"
            }
        }
    }
}

/// The exit codes as a Markdown table.
pub fn exit_table() -> String {
    let mut text = String::from("| exit code | meaning |\n|---|---|\n");
    for exit in Exit::ALL {
        text.push_str(&format!("| {} | {} |\n", exit.code(), exit.meaning()));
    }
    text
}
