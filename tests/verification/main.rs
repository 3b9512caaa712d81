//! Verification against closed forms and published results, named by their source.
mod hertz;
mod plate_under_ball;
mod punch;
mod support;
