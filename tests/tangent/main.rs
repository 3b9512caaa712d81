//! Tangents of contact and loads against dual numbers and closed forms.
mod follower;
mod normal;
mod support;
