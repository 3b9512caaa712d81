//! Entities of IGES files, one after another, and whole files of others.
mod areas;
mod builder;
mod conics;
mod curves;
mod points;
mod read;
mod splines;
#[allow(dead_code)]
#[path = "../io/support.rs"]
mod support;
mod surfaces;
mod swept;
mod trim;
mod trim_table;
mod untrusted;
