//! The compiled half of the Python package `covact`: runs and surfaces, with arrays of numpy.
//!
//! What is long runs without Python's lock, in a thread of its own, so that other threads of Python go on and Ctrl-C is
//! seen ([`work`]).
mod error;
mod geometry;
mod scene;
mod simulation;
mod study;
mod work;

use pyo3::prelude::*;

#[pymodule]
fn _covact(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add("__version__", env!("CARGO_PKG_VERSION"))?;
    m.add("Error", m.py().get_type::<error::Error>())?;
    m.add("SceneError", m.py().get_type::<error::SceneError>())?;
    m.add("NotConverged", m.py().get_type::<error::NotConverged>())?;
    m.add_class::<simulation::Simulation>()?;
    m.add_class::<simulation::Step>()?;
    m.add_class::<geometry::Surface>()?;
    m.add_function(wrap_pyfunction!(scene::check, m)?)?;
    m.add_function(wrap_pyfunction!(study::study, m)?)?;
    m.add_function(wrap_pyfunction!(study::main, m)?)?;
    Ok(())
}
