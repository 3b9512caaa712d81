//! Closest points of sets of patches: on patches, across their edges, and beside what trims leave out.
mod closest;
mod common;
mod curves;
mod faces;
mod tips;
mod topology;
mod topology_distance;
mod topology_trimmed;
mod topology_walk;
mod trim;
mod trim_closest;
mod work;
