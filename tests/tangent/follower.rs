//! The tangent of a follower pressure in the assembled system, and which borders make it unsymmetric.
use covact::assembly::Assembler;
use covact::model::Model;
use covact::model::build::build;
use covact::model::loads::follower_stiffness;
use covact::model::state::State;
use covact::scene;
use covact::system::Dof;
use nalgebra::DMatrix;
use serde_json::{Value, json};

/// A plate of 3 x 2 elements under a follower pressure on its upper face.
fn plate(supports: Value) -> Model {
    let scene = json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": 1000, "nu": 0.3}}},
        "bodies": {"b": {
            "mesh": {"plate": {"size": [3, 2], "thickness": 0.5, "elements": [3, 2]}},
            "material": "m"
        }},
        "supports": supports,
        "loads": {"p": {"on": "b.top", "pressure": "50*t", "follower": true}}
    });
    build(&scene::parse(&scene.to_string(), "scene.json").expect("a scene")).expect("a model")
}

fn held(edges: &[&str]) -> Value {
    let held = |edge: &&str| {
        (
            (*edge).to_owned(),
            json!({"on": format!("b.{edge}"), "fixed": true}),
        )
    };
    edges
        .iter()
        .map(held)
        .collect::<serde_json::Map<_, _>>()
        .into()
}

/// All entries of the tangent at `time` and a state without any order.
fn tangent(model: &Model, time: f64) -> (DMatrix<f64>, State) {
    let mut assembler = Assembler::new(model, &model.dofs).expect("a pattern");
    let mut state = State::new(model);
    let n = state.u.len();
    for (i, u) in state.u.iter_mut().enumerate() {
        *u = 0.05 * (1.7 * i as f64).sin();
    }
    let (mut residual, mut rhs) = (vec![0.0; n], vec![0.0; n]);
    (assembler.linearize(&mut state, time, None, &mut residual, &mut rhs)).expect("a tangent");
    let matrix = assembler.matrix();
    assert_eq!(matrix.is_symmetric(), model.symmetric);
    (DMatrix::from_fn(n, n, |i, j| matrix.get(i, j)), state)
}

/// The pressure's part of the tangent, by its value at two times, is minus the stiffness of its faces at all free
/// degrees of freedom: nothing is lost above or below the diagonal.
#[test]
fn the_assembled_follower_stiffness_is_that_of_the_faces() {
    let model = plate(held(&["x_min"]));
    assert!(!model.symmetric);
    let (without, state) = tangent(&model, 0.0);
    let (with, _) = tangent(&model, 1.0);
    let found = &with - &without;
    let mut expected = DMatrix::<f64>::zeros(found.nrows(), found.ncols());
    let mut k = [0.0; 729];
    for face in &model.follower_loads[0].1.faces {
        let nodes = face.nodes();
        let at = |k: usize| nodes.get(k).map(|&n| model.position(n as usize, &state.u));
        let x = std::array::from_fn(|k| at(k).unwrap_or_default());
        follower_stiffness(&x, face.count, 50.0, &mut k);
        let dof = |i: usize| 3 * nodes[i / 3] as usize + i % 3;
        for j in 0..12 {
            for i in 0..12 {
                expected[(dof(i), dof(j))] -= k[12 * j + i];
            }
        }
    }
    let free = |d: usize| model.dofs.dof(d) == Dof::Free;
    let (mut compared, mut unsymmetric) = (0, 0.0f64);
    for j in (0..found.ncols()).filter(|d| free(*d)) {
        for i in (0..found.nrows()).filter(|d| free(*d)) {
            // Of the elements' entries, about 1e3, the last digits are lost in the difference.
            let off = (found[(i, j)] - expected[(i, j)]).abs();
            assert!(off < 1e-11 * with.amax(), "({i}, {j}): {off:.1e}");
            compared += usize::from(expected[(i, j)] != 0.0);
            unsymmetric = unsymmetric.max((expected[(i, j)] - expected[(j, i)]).abs());
        }
    }
    assert!(
        compared > 200 && unsymmetric > 1.0,
        "{compared} {unsymmetric}"
    );
}

/// A border is quiet where it is held or slides in a plane of symmetry, and makes the system unsymmetric elsewhere; the
/// symmetric tangent is then exact, too.
#[test]
fn borders_decide_the_symmetry() {
    let all = ["x_min", "x_max", "y_min", "y_max"];
    for left_out in 0..4 {
        let some: Vec<&str> = (0..4).filter(|i| *i != left_out).map(|i| all[i]).collect();
        assert!(!plate(held(&some)).symmetric, "{some:?}");
        // Of the edge that is left out, the normal direction is held.
        let mut supports = held(&some);
        let slides = |axis: &str| json!({"on": format!("b.{}", all[left_out]), "symmetry": axis});
        let (across, along) = if left_out < 2 { ("x", "y") } else { ("y", "x") };
        supports["slides"] = slides(across);
        assert!(plate(supports.clone()).symmetric);
        supports["slides"] = slides(along);
        assert!(!plate(supports.clone()).symmetric);
        // A plane that is moved may turn, as far as is known beforehand.
        let opposite = all[left_out ^ 1];
        let neighbours = if left_out < 2 {
            ["y_min", "y_max"]
        } else {
            ["x_min", "x_max"]
        };
        let mut supports = held(&[opposite]);
        for edge in neighbours {
            supports[edge] = json!({"on": format!("b.{edge}"), "symmetry": along});
        }
        supports["slides"] = slides(across);
        assert!(plate(supports.clone()).symmetric);
        let moved = json!({"on": format!("b.{}", all[left_out]), "displacement": {across: "t"}});
        supports["slides"] = moved;
        assert!(!plate(supports).symmetric);
    }
    let mut quarter = held(&["x_max", "y_max"]);
    quarter["x"] = json!({"on": "b.x_min", "symmetry": "x"});
    quarter["y"] = json!({"on": "b.y_min", "symmetry": "y"});
    let model = plate(quarter);
    assert!(model.symmetric && model.unsymmetric.is_empty());
    let mut state = State::new(&model);
    for (i, u) in state.u.iter_mut().enumerate() {
        if model.dofs.dof(i) == Dof::Free {
            *u = 0.05 * (1.7 * i as f64).sin();
        }
    }
    let mut whole = DMatrix::<f64>::zeros(state.u.len(), state.u.len());
    let mut k = [0.0; 729];
    for face in &model.follower_loads[0].1.faces {
        let nodes = face.nodes();
        let at = |k: usize| nodes.get(k).map(|&n| model.position(n as usize, &state.u));
        let x = std::array::from_fn(|k| at(k).unwrap_or_default());
        follower_stiffness(&x, face.count, 50.0, &mut k);
        let dof = |i: usize| 3 * nodes[i / 3] as usize + i % 3;
        for (at, k) in k[..144].iter().enumerate() {
            whole[(dof(at % 12), dof(at / 12))] += k;
        }
    }
    let free: Vec<usize> = (0..state.u.len())
        .filter(|d| model.dofs.dof(*d) == Dof::Free)
        .collect();
    let part = whole.select_rows(&free).select_columns(&free);
    assert!(part.amax() > 1.0);
    assert!((&part - part.transpose()).amax() < 1e-13 * part.amax());
}
