//! Verification against closed forms and published results, named by their source.
mod die;
mod hertz;
mod loads;
mod placed;
mod plate_under_ball;
mod punch;
mod strip_over_cylinder;
mod support;
mod supports;
