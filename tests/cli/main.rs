//! The program as its users meet it: what it prints, where, and its exit code.
mod bad_files;
mod bad_model;
mod bad_pairs;
mod bad_text;
mod check;
mod convert;
mod effects;
mod inspect;
mod limits;
mod occupied;
mod output;
mod project;
mod resume;
mod run;
mod schema;
mod support;
