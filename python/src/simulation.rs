//! Runs.
use crate::error::{self, NotConverged};
use crate::scene::Source;
use crate::work::work;
use covact::output::Summary;
use covact::run::{self, Opened, Options, ResultsFolder, RunOptions, Sink, StepError};
use covact::scene::Stage;
use covact::solve::event::{Event, Observer, Silent};
use numpy::ndarray::Array2;
use numpy::{PyArray1, PyArray2, PyArrayMethods, ToPyArray};
use pyo3::exceptions::{PyKeyError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Mutex, PoisonError};

type Run<'o> = run::Simulation<'o>;

self_cell::self_cell!(
    /// A run with what interrupts it.
    struct Going {
        owner: AtomicBool,
        #[not_covariant]
        dependent: Run,
    }
);

/// Sends events as JSON texts to who waits for the work.
struct Teller(Sender<String>);

impl Observer for Teller {
    fn event(&mut self, event: &Event) {
        if let Ok(text) = serde_json::to_string(event) {
            // Nobody may be waiting.
            let _ = self.0.send(text);
        }
    }
}

/// An accepted step.
#[pyclass(frozen, get_all, module = "covact")]
pub struct Step {
    number: u32,
    time: f64,
    dt: f64,
    iterations: u32,
    cuts: u32,
    attempt: u32,
}

#[pymethods]
impl Step {
    fn __repr__(&self) -> String {
        let Step {
            number,
            time,
            iterations,
            ..
        } = self;
        format!("Step(number={number}, time={time}, iterations={iterations})")
    }
}

impl From<run::Step> for Step {
    fn from(s: run::Step) -> Self {
        Step {
            number: s.number,
            time: s.time,
            dt: s.dt,
            iterations: s.iterations,
            cuts: s.cuts,
            attempt: s.attempt,
        }
    }
}

/// A run of a scene; `covact.Simulation` is what Python shows of it.
#[pyclass(module = "covact")]
pub struct Simulation {
    /// Python may hand a run to another thread, which then has it alone.
    going: Mutex<Going>,
    folder: Option<Box<ResultsFolder>>,
    /// Events on their way to the observer.
    events: Option<(Mutex<Receiver<String>>, Py<PyAny>)>,
}

impl Simulation {
    /// Does something with the run that takes long.
    fn long<T: Send>(
        &mut self,
        py: Python<'_>,
        job: impl FnOnce(&mut Run<'_>, &mut [&mut dyn Sink]) -> T + Send,
    ) -> PyResult<T> {
        let Simulation {
            going,
            folder,
            events,
        } = self;
        let lock = events.as_ref().map(|(receiver, to)| (receiver.lock(), to));
        let events = match &lock {
            Some((Ok(receiver), to)) => Some((&**receiver, *to)),
            _ => None,
        };
        let going = going.get_mut().unwrap_or_else(PoisonError::into_inner);
        going.with_dependent_mut(|stop, run| {
            work(py, stop, events, || match folder {
                Some(folder) => job(run, &mut [&mut **folder]),
                None => job(run, &mut []),
            })
        })
    }

    fn read<T>(&self, of: impl FnOnce(&Run<'_>) -> T) -> T {
        let going = self.going.lock().unwrap_or_else(PoisonError::into_inner);
        going.with_dependent(|_, run| of(run))
    }

    fn lookup<T>(&self, of: impl FnOnce(&Run<'_>) -> Result<T, run::ReadError>) -> PyResult<T> {
        self.read(of).map_err(|e| match e {
            run::ReadError::NoStep => PyRuntimeError::new_err(e.to_string()),
            unknown => PyKeyError::new_err(unknown.to_string()),
        })
    }

    /// Index of a body.
    fn body(&self, name: &str) -> PyResult<usize> {
        // The message is the library's.
        self.lookup(|run| run.displacements(name).map(drop))?;
        let of = |run: &Run<'_>| run.model().bodies.iter().position(|b| b.name == name);
        self.read(of)
            .ok_or_else(|| PyKeyError::new_err(name.to_owned()))
    }
}

/// Where a run that goes into a folder has got to.
enum Start<'o> {
    Going(Box<Run<'o>>, Option<Box<ResultsFolder>>),
    Finished(Box<Summary>),
}

#[pymethods]
impl Simulation {
    /// A run at its start, or at the checkpoint in `out`.
    #[new]
    #[pyo3(signature = (source, out=None, resume=false, replace=false, threads=0, observer=None))]
    fn new(
        py: Python<'_>,
        source: Source<'_>,
        out: Option<PathBuf>,
        resume: bool,
        replace: bool,
        threads: usize,
        observer: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let loaded = source.load(py)?;
        let (observe, events): (Box<dyn Observer + Send>, _) = match observer {
            Some(to) => {
                let (send, receive) = mpsc::channel();
                (Box::new(Teller(send)), Some((Mutex::new(receive), to)))
            }
            None => (Box::new(Silent), None),
        };
        let mut folder = None;
        let mut finished = None;
        let going = Going::try_new(AtomicBool::new(false), |stop| {
            let caller = Options {
                threads,
                observer: observe,
                interrupt: stop,
            };
            // Building a large model takes a while, and cannot be interrupted.
            let started = py.detach(|| match &out {
                None => Run::new(loaded, caller).map(|run| Start::Going(Box::new(run), None)),
                Some(out) => {
                    let options = RunOptions {
                        threads,
                        resume,
                        force: replace,
                    };
                    run::open(&loaded, out, &options, caller).map(|opened| match opened {
                        Opened::Going(run, folder) => Start::Going(run, Some(folder)),
                        Opened::Finished(summary) => Start::Finished(summary),
                    })
                }
            });
            match started.map_err(|e| error::of_run(py, e))? {
                Start::Going(run, into) => {
                    folder = into;
                    Ok(*run)
                }
                Start::Finished(summary) => {
                    finished = Some(summary.status.name());
                    Err(error::plain("the run in this folder has reached its end"))
                }
            }
        });
        let going = going.map_err(|e| match (finished, &out) {
            (Some(_), Some(out)) => {
                let out = out.display();
                error::plain(format!(
                    "the run in {out} has reached its end: read it with `covact.read(...)`"
                ))
            }
            _ => e,
        })?;
        Ok(Simulation {
            going: Mutex::new(going),
            folder,
            events,
        })
    }

    /// The next accepted step, or None at the end.
    fn step(&mut self, py: Python<'_>) -> PyResult<Option<Step>> {
        match self.long(py, |run, sinks| run.step_into(sinks))? {
            Ok(step) => Ok(step.map(Step::from)),
            Err(StepError::NotConverged { reason }) => Err(NotConverged::new_err(reason)),
            Err(StepError::Interrupted) => Err(error::plain("interrupted")),
            Err(StepError::Run(e)) => Err(error::of_run(py, e)),
        }
    }

    /// Goes on to the end; the account as JSON.
    fn run(&mut self, py: Python<'_>) -> PyResult<String> {
        let summary = self.long(py, |run, sinks| run.run(sinks))?;
        let summary = summary.map_err(|e| error::of_run(py, e))?;
        serde_json::to_string(&summary).map_err(error::plain)
    }

    /// Ends the present stage here and goes on in another one, given as JSON.
    fn begin_stage(&mut self, py: Python<'_>, stage: &str) -> PyResult<()> {
        let stage: Stage = serde_json::from_str(stage)
            .map_err(|e| error::plain(format_args!("this is no stage: {e}")))?;
        self.long(py, |run, _| run.begin_stage(stage))?
            .map_err(|e| error::of_run(py, e))
    }

    /// The account so far as JSON.
    fn summary(&self) -> PyResult<String> {
        self.read(|run| serde_json::to_string(&run.summary()))
            .map_err(error::plain)
    }

    #[getter]
    fn time(&self) -> f64 {
        self.read(|run| run.time())
    }

    /// Time at the end of the run.
    #[getter]
    fn end_time(&self) -> f64 {
        self.read(|run| run.scene().scene.solution.end_time)
    }

    #[getter]
    fn steps(&self) -> u32 {
        self.read(|run| run.steps())
    }

    #[getter]
    fn done(&self) -> bool {
        self.read(|run| run.done())
    }

    #[getter]
    fn status(&self) -> Option<&'static str> {
        self.read(|run| run.status().map(|status| status.name()))
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.read(|run| run.warnings().to_vec())
    }

    /// Names of columns and their numbers, a row for each step.
    fn history<'py>(&self, py: Python<'py>) -> (Vec<String>, Bound<'py, PyArray2<f64>>) {
        self.read(|run| {
            let table = run.history();
            let columns = table.columns.len();
            let mut all = Array2::zeros((table.rows.len(), columns));
            for (row, numbers) in all.rows_mut().into_iter().zip(&table.rows) {
                row.into_iter().zip(numbers).for_each(|(to, x)| *to = *x);
            }
            (table.columns.clone(), PyArray2::from_owned_array(py, all))
        })
    }

    fn value(&self, column: &str) -> PyResult<f64> {
        self.lookup(|run| run.value(column))
    }

    /// Force and moment of a surface or support.
    fn force(&self, name: &str) -> PyResult<([f64; 3], [f64; 3])> {
        let found = self.lookup(|run| run.force(name))?;
        Ok((found.force.into(), found.moment.into()))
    }

    /// Forces and moments of both sides of a contact between bodies.
    fn contact_force(&self, contact: &str) -> PyResult<[([f64; 3], [f64; 3]); 2]> {
        let found = self.lookup(|run| run.contact_force(contact))?;
        Ok(found.map(|f| (f.force.into(), f.moment.into())))
    }

    /// Names of bodies, rigid surfaces, supports and contacts.
    fn names(&self, py: Python<'_>) -> PyResult<Py<PyDict>> {
        self.read(|run| {
            let model = run.model();
            let names = PyDict::new(py);
            let bodies: Vec<_> = model.bodies.iter().map(|b| b.name.as_str()).collect();
            let surfaces: Vec<_> = model.surfaces.iter().map(|s| s.name.as_str()).collect();
            let contacts: Vec<_> = model.pairs.iter().map(|p| p.name.as_str()).collect();
            names.set_item("bodies", bodies)?;
            names.set_item("surfaces", surfaces)?;
            names.set_item("supports", &model.supports)?;
            names.set_item("contacts", contacts)?;
            Ok(names.unbind())
        })
    }

    /// Undeformed nodes, nodes of the elements in VTK's order, and the type of these cells.
    #[allow(clippy::type_complexity)]
    fn mesh<'py>(
        &self,
        py: Python<'py>,
        body: &str,
    ) -> PyResult<(
        Bound<'py, PyArray2<f64>>,
        Bound<'py, PyArray2<i64>>,
        Bound<'py, PyDict>,
    )> {
        let index = self.body(body)?;
        self.read(|run| {
            let mesh = &run.model().bodies[index].mesh;
            let mut nodes = Array2::zeros((mesh.nodes.len(), 3));
            for (mut row, x) in nodes.rows_mut().into_iter().zip(&mesh.nodes) {
                (0..3).for_each(|c| row[c] = x[c]);
            }
            let each = mesh.kind.nodes();
            let mut cells = Array2::zeros((mesh.elements(), each));
            for (e, mut row) in cells.rows_mut().into_iter().enumerate() {
                let nodes = mesh.element(e);
                (row.iter_mut().zip(nodes)).for_each(|(to, node)| *to = i64::from(*node));
            }
            let sets = PyDict::new(py);
            for (name, set) in &mesh.node_sets {
                sets.set_item(name, set.to_pyarray(py))?;
            }
            Ok((
                PyArray2::from_owned_array(py, nodes),
                PyArray2::from_owned_array(py, cells),
                sets,
            ))
        })
    }

    /// Fields of a body at its nodes by name: arrays of shape (n,) or (n, components).
    fn fields<'py>(&self, py: Python<'py>, body: &str) -> PyResult<Bound<'py, PyDict>> {
        let fields = self.lookup(|run| run.fields(body))?;
        let out = PyDict::new(py);
        for field in fields {
            let flat = PyArray1::from_vec(py, field.data);
            let each = field.components;
            let array = match each {
                1 => flat.into_any(),
                _ => {
                    let rows = flat.len()? / each;
                    flat.reshape([rows, each])?.into_any()
                }
            };
            out.set_item(field.name, array)?;
        }
        Ok(out)
    }

    fn displacements<'py>(
        &self,
        py: Python<'py>,
        body: &str,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let u = self.lookup(|run| run.displacements(body))?;
        let mut out = Array2::zeros((u.len(), 3));
        for (mut row, x) in out.rows_mut().into_iter().zip(&u) {
            (0..3).for_each(|c| row[c] = x[c]);
        }
        Ok(PyArray2::from_owned_array(py, out))
    }
}
