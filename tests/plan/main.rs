//! The plan of a run: what it says, that it is what is done, and that effects that are off take no memory.
mod kernels;
mod scenes;
mod shipped;
mod sizes;
mod without;
