//! Time of one element evaluation on one core, by formulation and law.
use covact::mesh::{ElementKind, Mesh};
use covact::scene::{Elastic, HardeningCurve, LinearHardening, Material, Metal};
use covact::shell::{Formulation, H8Block, H8System, Law};
use covact_geometry::Vec3;
use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;

fn element(c: &mut Criterion) {
    let nodes: [Vec3; 8] = std::array::from_fn(|a| {
        let (i, j, k) = ((a & 1) as f64, ((a >> 1) & 1) as f64, (a >> 2) as f64);
        Vec3::new(
            2.0 * i + 0.3 * i * j,
            1.5 * j + 0.2 * i,
            0.3 * k + 0.1 * i * j,
        )
    });
    let mesh = Mesh {
        kind: ElementKind::H8,
        nodes: nodes.to_vec(),
        connectivity: (0..8).collect(),
        node_sets: Default::default(),
        face_sets: Default::default(),
    };
    let u = nodes.map(|x| Vec3::new(0.01 * x.y * x.x, -0.02 * x.x * x.z, 0.01 * x.x * x.x));
    let elastic = Elastic {
        e: 210e3,
        nu: 0.3,
        density: None,
    };
    // Its yield stress is passed by far at all points.
    let metal = Metal {
        e: 210e3,
        nu: 0.3,
        density: None,
        hardening: HardeningCurve::Linear(LinearHardening {
            yield_stress: 200.0,
            slope: 1000.0,
        }),
    };
    for (name, material) in [
        ("st_venant_kirchhoff", Material::StVenantKirchhoff(elastic)),
        ("neo_hooke", Material::NeoHooke(elastic)),
        ("hencky", Material::Hencky(elastic)),
        ("j2", Material::J2(metal)),
    ] {
        let Ok(law) = Law::new(&material) else { return };
        for formulation in [
            Formulation::Eas7,
            Formulation::Eas3,
            Formulation::Eas0,
            Formulation::Displacement,
            Formulation::MeanDilatation,
            Formulation::Layered,
        ] {
            let Ok(block) = H8Block::new(&mesh, formulation, law) else {
                return;
            };
            let mut state = vec![0.0; block.state_len()];
            let mut out = H8System::default();
            c.bench_function(&format!("evaluate/{name}/{formulation:?}"), |b| {
                b.iter(|| block.evaluate(0, black_box(&u), &mut state, &mut out))
            });
            let mut f = [0.0; 24];
            c.bench_function(&format!("residual/{name}/{formulation:?}"), |b| {
                b.iter(|| block.residual(0, black_box(&u), &state, &mut f))
            });
        }
    }
}

criterion_group!(benches, element);
criterion_main!(benches);
