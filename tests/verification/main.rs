//! Verification against closed forms and published results, named by their source.
mod ball_by_weight;
mod body_scenes;
mod die;
mod driven;
mod facets;
mod hertz;
mod hertz_bodies;
mod hinged_roof;
mod loads;
mod overclosure;
mod placed;
mod plate_under_ball;
mod punch;
mod quadratic;
mod strip_over_cylinder;
mod support;
mod supports;
