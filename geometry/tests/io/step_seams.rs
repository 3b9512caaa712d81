//! Faces of STEP files whose boundary runs along the seam of a closed surface, through its poles and round a hole across the
//! seam, as space curves only.

use crate::step_builder::{Step, area, near, set, volume};
use std::f64::consts::PI;

const X: [f64; 3] = [1., 0., 0.];
const Y: [f64; 3] = [0., 1., 0.];
const Z: [f64; 3] = [0., 0., 1.];
const ORIGIN: [f64; 3] = [0.; 3];

/// Half a circle of radius 5 in the plane of x and z, from the south to the north pole.
const HALF_CIRCLE: &str = "(BOUNDED_CURVE()B_SPLINE_CURVE(2,(#S,#SE,#E,#NE,#N),.UNSPECIFIED.,.F.,.F.)\
    B_SPLINE_CURVE_WITH_KNOTS((3,2,3),(0.,1.,2.),.UNSPECIFIED.)CURVE()GEOMETRIC_REPRESENTATION_ITEM()\
    RATIONAL_B_SPLINE_CURVE((1.,0.7071067811865476,1.,0.7071067811865476,1.))REPRESENTATION_ITEM(''))";

/// A ball of radius 5 whose seam begins in the direction `seam`, as a sphere or as a spline turned about its axis.
fn ball(step: &mut Step, seam: [f64; 3], turned: bool) -> String {
    if !turned {
        let place = step.placement(ORIGIN, Z, seam);
        return step.placed("SPHERICAL_SURFACE", &place, "5.");
    }
    let at = |x: f64, z: f64| [5. * x * seam[0], 5. * x * seam[1], 5. * z];
    let mut curve = HALF_CIRCLE.to_owned();
    let points = [
        ("#SE", at(1., -1.)),
        ("#NE", at(1., 1.)),
        ("#S", at(0., -1.)),
        ("#N", at(0., 1.)),
        ("#E", at(1., 0.)),
    ];
    for (name, x) in points {
        let point = step.point(x);
        for end in [",", ")"] {
            curve = curve.replace(&format!("{name}{end}"), &format!("{point}{end}"));
        }
    }
    let curve = step.add(curve);
    let (at, z) = (step.point(ORIGIN), step.direction(Z));
    let axis = step.add(format!("AXIS1_PLACEMENT('',{at},{z})"));
    step.add(format!("SURFACE_OF_REVOLUTION('',{curve},{axis})"))
}

/// The ball is cut by the plane x = 4. Its boundary runs from the circle to the north pole and back, halfway round the circle,
/// to the south pole and back, and round the other half: of the ways to go on at the two poles one bounds the face.
#[test]
fn hole_across_the_seam_between_two_poles() {
    for turned in [false, true] {
        for seam in [X, Y, [0.8, 0.6, 0.]] {
            let mut step = Step::default();
            let [north, south] = [5., -5.].map(|z| step.vertex([0., 0., z]));
            let [a, b] = [3., -3.].map(|z| step.vertex([4., 0., z]));
            let place = step.placement(ORIGIN, [0., -1., 0.], X);
            let meridian = step.placed("CIRCLE", &place, "5.");
            let up = step.edge([&a, &north], &meridian);
            let down = step.edge([&south, &b], &meridian);
            let place = step.placement([4., 0., 0.], [-1., 0., 0.], Z);
            let circle = step.placed("CIRCLE", &place, "3.");
            let right = step.edge([&a, &b], &circle);
            let left = step.edge([&b, &a], &circle);
            let (back_up, back_down) = (format!("-{up}"), format!("-{down}"));
            let bound = step.bound(&[&up, &back_up, &right, &back_down, &down, &left]);
            let sphere = ball(&mut step, seam, turned);
            let dome = step.face(&[&bound], &sphere, true);
            let bound = step.bound(&[&format!("-{left}"), &format!("-{right}")]);
            let place = step.placement([4., 0., 0.], X, Y);
            let plane = step.placed("PLANE", &place, "");
            let lid = step.face(&[&bound], &plane, true);
            let solid = step.solid(&[&dome, &lid]);
            let set = set(&step.whole(&[&solid]), None);
            near(area(&set), 99. * PI, 1e-6);
            near(volume(&set), PI * (500. - 14.) / 3., 1e-6);
        }
    }
}
