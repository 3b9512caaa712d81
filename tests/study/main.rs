//! Studies: from a file to scenes, processes and records.
mod collect;
mod elsewhere;
mod expansion;
mod failing;
mod killed;
mod playing;
mod support;
mod triangles;
mod wrong;
