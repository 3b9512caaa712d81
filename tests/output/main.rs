//! Files of results.
mod atomic;
mod folder;
mod vtu;
