//! Helpers: surface areas, and IGES files from a few lines.

use covact_geometry::NurbsPatch;
use std::fmt::Write;
use std::path::PathBuf;

pub fn assets() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../assets"))
}

/// Points and weights of Gauss-Legendre quadrature on [0, 1], by Newton's method on the Legendre polynomial.
fn gauss(n: u32) -> Vec<(f64, f64)> {
    let legendre = |x: f64| {
        let (mut p, mut q) = (1.0, 0.0);
        for k in 1..=n {
            let k = f64::from(k);
            (p, q) = (((2.0 * k - 1.0) * x * p - (k - 1.0) * q) / k, p);
        }
        (p, f64::from(n) * (x * p - q) / (x * x - 1.0))
    };
    (1..=n)
        .map(|i| {
            let angle = std::f64::consts::PI * (f64::from(i) - 0.25) / (f64::from(n) + 0.5);
            let mut x = angle.cos();
            for _ in 0..20 {
                let (p, slope) = legendre(x);
                x -= p / slope;
            }
            let slope = legendre(x).1;
            (0.5 + 0.5 * x, 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// Area by 12 x 12 Gauss points on a quarter of each knot span.
pub fn area(patch: &NurbsPatch) -> f64 {
    let rule = gauss(12);
    let halves = |dir| -> Vec<[f64; 2]> {
        let spans = patch.spans(dir).into_iter();
        spans
            .flat_map(|[a, b]| [[a, 0.5 * (a + b)], [0.5 * (a + b), b]])
            .collect()
    };
    let mut area = 0.0;
    for [u0, u1] in halves(0) {
        for [v0, v1] in halves(1) {
            for (x, wx) in &rule {
                for (y, wy) in &rule {
                    let jet = patch.jet([u0 + (u1 - u0) * x, v0 + (v1 - v0) * y]);
                    let size = jet.rho_i[0].cross(&jet.rho_i[1]).norm();
                    area += size * wx * wy * (u1 - u0) * (v1 - v0);
                }
            }
        }
    }
    area
}

/// One entity for [`iges`].
pub struct Entity<'a> {
    pub type_number: u32,
    pub form: i32,
    /// Directory number of its matrix, or 0.
    pub matrix: u32,
    pub status: &'a str,
    pub label: &'a str,
    /// Values without the type number in front.
    pub values: String,
}

pub fn entity(type_number: u32, values: &str) -> Entity<'static> {
    Entity {
        type_number,
        form: 0,
        matrix: 0,
        status: "00000000",
        label: "",
        values: values.to_owned(),
    }
}

/// An entity that is a part of another.
pub fn child(type_number: u32, values: &str) -> Entity<'static> {
    Entity {
        status: "00010000",
        ..entity(type_number, values)
    }
}

/// A 128 in the plane z = 0 over [0, a] x [0, b] with these as parameters.
pub fn flat(a: f64, b: f64) -> String {
    format!(
        "1,1,1,1,0,0,1,0,0,0.,0.,{a:?},{a:?},0.,0.,{b:?},{b:?},1.,1.,1.,1.,\
         0.,0.,0.,{a:?},0.,0.,0.,{b:?},0.,{a:?},{b:?},0.,0.,{a:?},0.,{b:?}"
    )
}

/// A line in the plane z = 0.
pub fn line(from: [f64; 2], to: [f64; 2]) -> Entity<'static> {
    let [[a, b], [c, d]] = [from, to];
    child(110, &format!("{a:?},{b:?},0.,{c:?},{d:?},0."))
}

/// Millimetres, usual delimiters.
pub const GLOBAL: &str = "1H,,1H;,4Htest,4Htest,1H1,1H1,32,38,6,308,15,,1.,2,2HMM,1,0.01,,1.E-6;";

/// An IGES file; entity k (from 0) has directory number 2 k + 1.
pub fn iges(global: &str, entities: &[Entity]) -> String {
    iges_with(global, entities, ',', ';')
}

pub fn iges_with(global: &str, entities: &[Entity], comma: char, end: char) -> String {
    let cut = |text: &str, width: usize| -> Vec<String> {
        let chars: Vec<char> = text.chars().collect();
        chars.chunks(width).map(|c| c.iter().collect()).collect()
    };
    let mut file = format!("{:<72}S{:>7}\n", "by hand", 1);
    let globals = cut(global, 72);
    for (i, line) in globals.iter().enumerate() {
        writeln!(file, "{line:<72}G{:>7}", i + 1).unwrap();
    }
    let (mut directory, mut parameter) = (String::new(), String::new());
    let mut count = 0;
    for (k, e) in entities.iter().enumerate() {
        let lines = cut(&format!("{}{comma}{}{end}", e.type_number, e.values), 64);
        let (number, start) = (2 * k + 1, count + 1);
        let first = format!(
            "{:>8}{start:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}",
            e.type_number, 0, 0, 0, 0, e.matrix, 0, e.status
        );
        let second = format!(
            "{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}",
            e.type_number,
            0,
            0,
            lines.len(),
            e.form,
            "",
            "",
            e.label,
            0
        );
        writeln!(directory, "{first}D{number:>7}\n{second}D{:>7}", number + 1).unwrap();
        for line in lines {
            count += 1;
            writeln!(parameter, "{line:<64}{number:>8}P{count:>7}").unwrap();
        }
    }
    let totals = format!(
        "S{:>7}G{:>7}D{:>7}P{count:>7}",
        1,
        globals.len(),
        2 * entities.len()
    );
    file + &directory + &parameter + &format!("{totals:<72}T{:>7}\n", 1)
}

/// Values of a bilinear 128 over the corners (0,0,0), (2,0,0), (0,1,0), (2,1,1) with K1 = K2 = 1.
pub fn bilinear() -> String {
    "1,1,1,1,0,0,1,0,0,0.,0.,1.,1.,0.,0.,1.,1.,1.,1.,1.,1.,\
     0.,0.,0.,2.,0.,0.,0.,1.,0.,2.,1.,1.,0.,1.,0.,1."
        .to_owned()
}
