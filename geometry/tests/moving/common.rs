//! Shared by the tests of moving facets: meshes, random motions, an exhaustive search.
#![allow(dead_code)]

use covact_geometry::{Hint, MovingFacets, MovingFoot, Vec3};

/// Splitmix64.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn between(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.next()
    }

    pub fn vector(&mut self, size: f64) -> Vec3 {
        Vec3::from_fn(|_, _| self.between(-size, size))
    }
}

/// Nodes and facets with `p + 1` nodes in each direction.
pub struct Mesh {
    pub nodes: Vec<Vec3>,
    pub facets: Vec<Vec<u32>>,
    pub count: [u8; 2],
}

impl Mesh {
    /// `n x m` facets of degree `p` over the unit square, mapped by `map`. Where `closed` says so the last line of nodes of that
    /// direction is the first.
    pub fn grid(
        [n, m]: [usize; 2],
        p: usize,
        closed: [bool; 2],
        map: impl Fn(f64, f64) -> Vec3,
    ) -> Self {
        let lines = [
            p * n + usize::from(!closed[0]),
            p * m + usize::from(!closed[1]),
        ];
        let nodes = (0..lines[0] * lines[1])
            .map(|k| {
                let (i, j) = (k % lines[0], k / lines[0]);
                map(i as f64 / (p * n) as f64, j as f64 / (p * m) as f64)
            })
            .collect();
        let mut facets = Vec::new();
        for j in 0..m {
            for i in 0..n {
                let node = |k: usize| {
                    let (a, b) = (i * p + k % (p + 1), j * p + k / (p + 1));
                    (a % lines[0] + lines[0] * (b % lines[1])) as u32
                };
                facets.push((0..(p + 1) * (p + 1)).map(node).collect());
            }
        }
        Self {
            nodes,
            facets,
            count: [p as u8 + 1; 2],
        }
    }

    pub fn list(&self) -> Vec<(&[u32], [u8; 2])> {
        self.facets.iter().map(|f| (&f[..], self.count)).collect()
    }

    /// The facets as they are.
    pub fn faceted(&self) -> MovingFacets {
        MovingFacets::new(&self.list()).unwrap()
    }

    /// The smooth surface, positions taken as reference.
    pub fn smooth(&self) -> MovingFacets {
        MovingFacets::smooth(&self.list(), |k| self.nodes[k as usize]).unwrap()
    }

    /// Nodes after a smooth random motion with a little noise.
    pub fn deformed(&self, size: f64, noise: f64, seed: u64) -> Vec<Vec3> {
        let mut random = Random(seed);
        let waves: Vec<(Vec3, Vec3, f64)> = (0..4)
            .map(|_| {
                (
                    random.vector(size),
                    random.vector(3.0),
                    random.between(0.0, 6.0),
                )
            })
            .collect();
        (self.nodes.iter())
            .map(|x| {
                let wave =
                    |s: Vec3, (a, k, phase): &(Vec3, Vec3, f64)| s + a * (k.dot(x) + phase).sin();
                x + waves.iter().fold(Vec3::zeros(), wave) + random.vector(noise)
            })
            .collect()
    }
}

/// Closed torus of radii 2 and 0.7, normals outwards.
pub fn torus(n: [usize; 2], p: usize) -> Mesh {
    Mesh::grid(n, p, [true; 2], |u, v| {
        let (a, b) = (u * std::f64::consts::TAU, v * std::f64::consts::TAU);
        let r = 2.0 + 0.7 * b.cos();
        Vec3::new(r * a.cos(), r * a.sin(), 0.7 * b.sin())
    })
}

/// Wavy sheet.
pub fn sheet(n: [usize; 2], p: usize) -> Mesh {
    Mesh::grid(n, p, [false; 2], |u, v| {
        Vec3::new(3.0 * u, 3.0 * v, 0.4 * (4.0 * u).sin() * (3.0 * v).cos())
    })
}

/// Surface of the unit cube, `n` facets along an edge, normals outwards; shared nodes.
pub fn cube(n: usize) -> Mesh {
    let mut nodes: Vec<Vec3> = Vec::new();
    let mut numbers = std::collections::HashMap::new();
    let mut facets = Vec::new();
    for axis in 0..3 {
        for end in 0..2 {
            let mut node = |i: usize, j: usize| {
                let mut place = [0; 3];
                place[axis] = end * n;
                // u x v points along +axis at the far end and along -axis at the near one.
                let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
                let (a, b) = if end == 1 { (a, b) } else { (b, a) };
                (place[a], place[b]) = (i, j);
                *numbers.entry(place).or_insert_with(|| {
                    nodes.push(Vec3::from(place.map(|k| k as f64 / n as f64)));
                    nodes.len() as u32 - 1
                })
            };
            for j in 0..n {
                for i in 0..n {
                    facets.push(vec![
                        node(i, j),
                        node(i + 1, j),
                        node(i, j + 1),
                        node(i + 1, j + 1),
                    ]);
                }
            }
        }
    }
    Mesh {
        nodes,
        facets,
        count: [2; 2],
    }
}

/// Distance by exhaustive search: a grid of points on every facet, then a damped Gauss-Newton iteration with clamping from
/// the best of each of the nearest facets. Shares no code with the search under test but the jets.
pub fn exhaustive(set: &MovingFacets, q: &Vec3, accept: impl Fn(u32) -> bool) -> f64 {
    const STEPS: usize = 8;
    let mut seeds: Vec<(f64, u32, [f64; 2])> = Vec::new();
    for facet in (0..set.len() as u32).filter(|f| accept(*f)) {
        for k in 0..(STEPS + 1) * (STEPS + 1) {
            let xi =
                [k % (STEPS + 1), k / (STEPS + 1)].map(|k| 2.0 * k as f64 / STEPS as f64 - 1.0);
            seeds.push(((set.jet(facet, xi).rho - q).norm_squared(), facet, xi));
        }
    }
    seeds.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best = f64::INFINITY;
    for &(_, facet, xi) in seeds.iter().take(16) {
        best = best.min(refine(set, facet, xi, q));
    }
    best.sqrt()
}

fn refine(set: &MovingFacets, facet: u32, mut xi: [f64; 2], q: &Vec3) -> f64 {
    let value = |xi: [f64; 2]| (set.jet(facet, xi).rho - q).norm_squared();
    let mut now = value(xi);
    let mut damping = 1e-3;
    for _ in 0..300 {
        let jet = set.jet(facet, xi);
        let d = q - jet.rho;
        let g = [jet.rho_i[0].dot(&d), jet.rho_i[1].dot(&d)];
        let h = |i: usize, j: usize| jet.rho_i[i].dot(&jet.rho_i[j]) - jet.rho_ij[i + j].dot(&d);
        let a = [jet.rho_i[0].norm_squared(), jet.rho_i[1].norm_squared()];
        let shift = damping * (a[0].max(a[1]) + 1e-300);
        let held = |k: usize| xi[k] <= -1.0 && g[k] < 0.0 || xi[k] >= 1.0 && g[k] > 0.0;
        let (h11, h12, h22) = (h(0, 0) + shift, h(0, 1), h(1, 1) + shift);
        let step = match [held(0), held(1)] {
            [true, true] => return now,
            [true, false] => [0.0, g[1] / h22.abs().max(1e-300)],
            [false, true] => [g[0] / h11.abs().max(1e-300), 0.0],
            _ => {
                let det = h11 * h22 - h12 * h12;
                if det > 0.0 && h11 > 0.0 {
                    [
                        (h22 * g[0] - h12 * g[1]) / det,
                        (h11 * g[1] - h12 * g[0]) / det,
                    ]
                } else {
                    damping = damping.max(1e-3) * 4.0;
                    if damping > 1e12 {
                        return now;
                    }
                    continue;
                }
            }
        };
        let next = [0, 1].map(|k| (xi[k] + step[k]).clamp(-1.0, 1.0));
        let then = value(next);
        if then < now {
            now = then;
            xi = next;
            damping *= 0.2;
        } else {
            damping = damping.max(1e-9) * 8.0;
            if damping > 1e9 || next == xi {
                return now;
            }
        }
    }
    now
}

/// Checks that a foot is a point of the set, as far away as it says, and stationary where it claims to be.
pub fn check_foot(set: &MovingFacets, q: &Vec3, foot: &MovingFoot) {
    use covact_geometry::{MovingPlace, Status};
    let rho = set.jet(foot.facet, foot.xi).rho;
    let noise = 1e-12 * (set.size() + q.norm());
    assert!((rho - foot.jet.rho).norm() <= noise, "{q:?} {foot:?}");
    assert!(
        ((q - rho).norm() - foot.distance).abs() <= noise,
        "{q:?} {foot:?}"
    );
    assert!((foot.signed_distance.abs() - foot.distance).abs() <= noise);
    assert!((foot.normal.norm() - 1.0).abs() < 1e-12, "{q:?} {foot:?}");
    let inside = foot.xi.iter().all(|x| x.abs() < 1.0);
    if inside && foot.place == MovingPlace::Face && foot.status == Status::Unique {
        for tangent in foot.jet.rho_i {
            let residual = tangent.dot(&(q - foot.jet.rho)).abs();
            let scale = tangent.norm() * foot.distance.max(set.size());
            assert!(residual <= 2e-12 * scale, "{residual:e} {q:?} {foot:?}");
        }
    }
}

pub fn hint(facet: u32, xi: [f64; 2]) -> Option<Hint> {
    Some(Hint { patch: facet, xi })
}

/// Partition of unity, and that the combination of the nodes is the point with its tangents.
pub fn check_shape(
    set: &MovingFacets,
    facet: u32,
    xi: [f64; 2],
    rows: &covact_geometry::ShapeRows,
    position: impl Fn(u32) -> Vec3,
) {
    let nodes = set.nodes(facet);
    assert_eq!(rows.count, nodes.len());
    let sum = |n: &[f64]| n[..rows.count].iter().sum::<f64>();
    assert!(
        (sum(&rows.n) - 1.0).abs() < 1e-14,
        "{:e}",
        sum(&rows.n) - 1.0
    );
    assert!(sum(&rows.n_1).abs() < 1e-14 && sum(&rows.n_2).abs() < 1e-14);
    let jet = set.jet(facet, xi);
    let combine = |n: &[f64]| {
        let terms = nodes.iter().zip(n);
        terms.fold(Vec3::zeros(), |s, (&k, n)| s + position(k) * *n)
    };
    for (n, v) in [
        (&rows.n, jet.rho),
        (&rows.n_1, jet.rho_i[0]),
        (&rows.n_2, jet.rho_i[1]),
    ] {
        assert!(
            v.norm() > 0.0 && (combine(n) - v).norm() < 2e-14,
            "{:e}",
            (combine(n) - v).norm()
        );
    }
}
