//! Errors as exceptions that carry where the fault is.
use covact::run::RunError;
use covact::scene::{Problem, SceneError as Wrong};
use pyo3::create_exception;
use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

create_exception!(
    covact,
    Error,
    PyException,
    "What covact could not do, in words."
);
create_exception!(
    covact,
    SceneError,
    Error,
    "A scene, or a file that it names, is wrong. `problems` lists all that was found, each a dict with `message`, `help`, \
     `pointer` (a JSON pointer into the scene), `line` and `column`."
);
create_exception!(
    covact,
    NotConverged,
    Error,
    "No equilibrium was found, even with the smallest step. What was computed before is kept."
);

/// An error without a place.
pub fn plain(message: impl std::fmt::Display) -> PyErr {
    Error::new_err(message.to_string())
}

/// A fault of a scene: one item of `problems`.
struct Item {
    message: String,
    help: Option<String>,
    pointer: String,
    place: Option<(usize, usize)>,
}

impl From<&Problem> for Item {
    fn from(p: &Problem) -> Self {
        Item {
            message: p.message.clone(),
            help: p.help.clone(),
            pointer: p.pointer.clone(),
            place: Some((p.place.line, p.place.column)),
        }
    }
}

fn raise(py: Python<'_>, items: &[Item]) -> PyErr {
    let line = |item: &Item| {
        let help = (item.help.as_ref()).map_or(String::new(), |help| format!(" ({help})"));
        let at = match item.pointer.as_str() {
            "" => "scene",
            pointer => pointer,
        };
        format!("{at}: {}{help}", item.message)
    };
    let text: Vec<String> = items.iter().map(line).collect();
    let error = SceneError::new_err(text.join("\n"));
    let fill = || -> PyResult<()> {
        let list = PyList::empty(py);
        for item in items {
            let one = PyDict::new(py);
            one.set_item("message", &item.message)?;
            one.set_item("help", item.help.as_ref())?;
            one.set_item("pointer", &item.pointer)?;
            one.set_item("line", item.place.map(|p| p.0))?;
            one.set_item("column", item.place.map(|p| p.1))?;
            list.append(one)?;
        }
        error.value(py).setattr("problems", list)
    };
    match fill() {
        Ok(()) => error,
        Err(other) => other,
    }
}

/// What is wrong with the text of a scene.
pub fn of_scene(py: Python<'_>, error: &Wrong) -> PyErr {
    match error {
        Wrong::Wrong { problems, .. } => {
            raise(py, &problems.iter().map(Item::from).collect::<Vec<_>>())
        }
        other => SceneError::new_err(other.to_string()),
    }
}

/// What a check of a scene has found.
pub fn of_problems(py: Python<'_>, problems: &[Problem]) -> PyErr {
    raise(py, &problems.iter().map(Item::from).collect::<Vec<_>>())
}

/// Why a run could not be done.
pub fn of_run(py: Python<'_>, error: RunError) -> PyErr {
    let mut items = Vec::new();
    let rest = gather(error, &mut items);
    match rest {
        None => raise(py, &items),
        Some(error) => plain(error),
    }
}

/// Lists the faults of a scene; gives back an error that is none.
fn gather(error: RunError, items: &mut Vec<Item>) -> Option<RunError> {
    match error {
        RunError::Scene {
            message,
            pointer,
            place,
            help,
            others,
        } => {
            items.push(Item {
                message,
                help,
                pointer,
                place: place.map(|p| (p.line, p.column)),
            });
            for other in others {
                gather(other, items);
            }
            None
        }
        other => Some(other),
    }
}
