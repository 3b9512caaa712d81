//! Reading CAD files: samples of several writers, damaged files, small files written by hand, and the punch of the
//! examples.

mod contradictions;
mod damage;
mod habits;
mod healing;
mod iges;
mod iges_records;
mod iges_shells;
mod iges_write;
mod json;
#[path = "../mutate_common/mod.rs"]
mod mutate;
mod offsets;
mod punch;
mod round;
mod samples;
mod spikes;
mod step;
mod step_builder;
mod step_forms;
mod step_hidden;
mod step_mutants;
mod step_pcurves;
mod step_poles;
mod step_seams;
mod step_shapes;
mod step_text;
mod support;
mod surface;
mod volumes;
