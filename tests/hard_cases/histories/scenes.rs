//! What is changed in the shipped scenes so that all of them together run in a minute of processor time with the dev
//! profile: coarser meshes, or a part of their time. Contact, sliding and what else a scene is there for remain.
use crate::support::set;
use serde_json::{Value, json};

/// What is changed in a scene.
pub type Change = fn(&mut Value);

fn elements(scene: &mut Value, body: &str, kind: &str, count: Value) {
    set(
        scene,
        &format!("/bodies/{body}/mesh/{kind}/elements"),
        count,
    );
}

fn end(scene: &mut Value, time: f64) {
    set(scene, "/solution/end_time", time);
}

pub fn ball_by_weight(_: &mut Value) {}

/// Pressed and dragged a little.
pub fn ball_drag(scene: &mut Value) {
    end(scene, 1.3);
}

pub fn ball_on_plate(_: &mut Value) {}

pub fn crossed_tubes(scene: &mut Value) {
    for body in ["lower", "upper"] {
        elements(scene, body, "cylinder_panel", json!([12, 8]));
    }
}

/// Coarser, and bent less.
pub fn bend_and_release(scene: &mut Value) {
    elements(scene, "strip", "plate", json!([20, 1]));
    set(scene, "/stages/0/tools/punch/2", -6);
}

/// The bead closes, and the sheet begins to slide.
pub fn draw_bead(scene: &mut Value) {
    end(scene, 1.2);
}

/// The ring dents and slides.
pub fn drop(scene: &mut Value) {
    elements(scene, "ring", "cylinder_panel", json!([24, 2]));
    end(scene, 0.004);
}

/// Coarser, and until the punch has dented the panel.
pub fn flanged_panel(scene: &mut Value) {
    set(scene, "/bodies/panel/nurbs/size", 12);
    scene["solution"]["end_time"] = json!(0.5);
}

/// Coarser.
pub fn gravity_drape(scene: &mut Value) {
    elements(scene, "sheet", "plate", json!([18, 12]));
}

pub fn hat_pressed(_: &mut Value) {}

pub fn hertz_block(scene: &mut Value) {
    elements(scene, "block", "block", json!([10, 10, 10]));
    for axis in 0..3 {
        let fine = format!("/bodies/block/mesh/block/spacing/{axis}/fine/fine");
        set(scene, &fine, 6);
    }
}

pub fn ironing(_: &mut Value) {}

/// Coarser, and down to where the punch sits on its rim.
pub fn panel_pressed(scene: &mut Value) {
    set(scene, "/bodies/panel/nurbs/size", 9);
    scene["solution"]["end_time"] = json!(0.6);
}

pub fn pinched_tube(scene: &mut Value) {
    elements(scene, "tube", "cylinder_panel", json!([16, 12]));
}

pub fn press_pads(scene: &mut Value) {
    elements(scene, "sheet", "plate", json!([32, 13]));
}

pub fn punch_sheet(scene: &mut Value) {
    elements(scene, "sheet", "plate", json!([20, 16]));
}

pub fn q18_on_h8(scene: &mut Value) {
    elements(scene, "cap", "sphere_panel", json!([3, 3]));
    elements(scene, "block", "block", json!([9, 9, 3]));
}

pub fn sandwiched_shell(scene: &mut Value) {
    elements(scene, "below", "block", json!([8, 8, 3]));
    elements(scene, "sheet", "plate", json!([10, 10]));
    elements(scene, "above", "block", json!([5, 5, 3]));
}

pub fn sheet_in_die(scene: &mut Value) {
    elements(scene, "sheet", "plate", json!([19, 19]));
}

/// Wrapped, and drawn a little.
pub fn strip_drawn(scene: &mut Value) {
    end(scene, 1.25);
}

pub fn strip_over_cylinder(_: &mut Value) {}

/// Coarser, and drawn a little.
pub fn sheet_over_hills(scene: &mut Value) {
    set(scene, "/bodies/sheet/nurbs/size", 4);
    end(scene, 1.6);
}

/// Coarser, and until both bumps have met.
pub fn snap_clip_nurbs(scene: &mut Value) {
    for body in ["hook", "catch"] {
        set(scene, &format!("/bodies/{body}/nurbs/size"), 3);
    }
    end(scene, 0.5);
}

/// Coarser, and pressed a little.
pub fn folded_panel(scene: &mut Value) {
    set(scene, "/bodies/panel/nurbs/size", 6);
    end(scene, 0.4);
}

/// Coarser, and until the upper tube slides.
pub fn tubes_crossed_nurbs(scene: &mut Value) {
    for body in ["lower", "upper"] {
        set(scene, &format!("/bodies/{body}/nurbs/size"), 10);
    }
    end(scene, 1.2);
}

/// Drawn in a little.
pub fn deep_cup(scene: &mut Value) {
    set(scene, "/stages/0/tools/punch/2", json!(-0.5));
}

/// Bent into the die without a holder, a little.
pub fn u_channel(scene: &mut Value) {
    set(scene, "/stages/0/tools/punch/2", -1);
    for (part, name) in [("contacts", "under_holder"), ("surfaces", "holder")] {
        let part = scene[part].as_object_mut().expect("an object");
        part.remove(name).expect("the holder");
    }
}
