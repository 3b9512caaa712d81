//! Studies: from a file to scenes, processes and records.
mod collect;
mod expansion;
mod failing;
mod playing;
mod support;
mod triangles;
mod wrong;
