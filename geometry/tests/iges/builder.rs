//! IGES files written from lists of entities: 80-column records, numbered and counted.
//!
//! ```text
//! let mut file = Builder::new();
//! let axis = file.add(110, "0.,0.,0.,0.,0.,1.");
//! let arc = file.entity(Entity { form: 0, ..Entity::new(100, "0.,0.,0.,1.,0.,0.,1.") });
//! file.add(120, &format!("{axis},{arc},0.,1."));
//! read_iges(file.text().as_bytes(), "name")
//! ```
#![allow(dead_code)]

use std::fmt::Write;

/// Millimetres, usual delimiters, resolution 1e-6.
pub const GLOBAL: &str = "1H,,1H;,4Htest,4Htest,1H1,1H1,32,38,6,308,15,,1.,2,2HMM,1,0.01,,1.E-6;";

/// One entity.
#[derive(Clone)]
pub struct Entity {
    pub type_number: u32,
    pub form: i32,
    /// Directory number of its matrix, or 0.
    pub matrix: u32,
    /// Eight digits: blank, subordinate, purpose, hierarchy.
    pub status: String,
    pub label: String,
    /// Values without the type number in front, separated by commas.
    pub values: String,
}

impl Entity {
    pub fn new(type_number: u32, values: &str) -> Self {
        Self {
            type_number,
            form: 0,
            matrix: 0,
            status: "00000000".to_owned(),
            label: String::new(),
            values: values.to_owned(),
        }
    }
}

/// A file in the making.
#[derive(Clone)]
pub struct Builder {
    pub global: String,
    pub entities: Vec<Entity>,
    /// Separator of values and end of a record; commas in values are replaced.
    pub delimiters: [char; 2],
}

impl Default for Builder {
    fn default() -> Self {
        Self::new()
    }
}

impl Builder {
    pub fn new() -> Self {
        Self {
            global: GLOBAL.to_owned(),
            entities: Vec::new(),
            delimiters: [',', ';'],
        }
    }

    /// Adds an entity of form 0 and returns its directory number.
    pub fn add(&mut self, type_number: u32, values: &str) -> u32 {
        self.entity(Entity::new(type_number, values))
    }

    /// Adds an entity of a form.
    pub fn form(&mut self, type_number: u32, form: i32, values: &str) -> u32 {
        self.entity(Entity {
            form,
            ..Entity::new(type_number, values)
        })
    }

    /// Adds an entity with a matrix.
    pub fn placed(&mut self, type_number: u32, matrix: u32, values: &str) -> u32 {
        self.entity(Entity {
            matrix,
            ..Entity::new(type_number, values)
        })
    }

    pub fn entity(&mut self, entity: Entity) -> u32 {
        self.entities.push(entity);
        2 * u32::try_from(self.entities.len()).unwrap() - 1
    }

    /// The whole file.
    pub fn text(&self) -> String {
        let [comma, end] = self.delimiters;
        let cut = |text: &str, width: usize| -> Vec<String> {
            let chars: Vec<char> = text.chars().collect();
            chars.chunks(width).map(|c| c.iter().collect()).collect()
        };
        let mut file = format!("{:<72}S{:>7}\n", "by hand", 1);
        let globals = cut(&self.global, 72);
        for (i, line) in globals.iter().enumerate() {
            writeln!(file, "{line:<72}G{:>7}", i + 1).unwrap();
        }
        let (mut directory, mut parameter) = (String::new(), String::new());
        let mut count = 0;
        for (k, e) in self.entities.iter().enumerate() {
            let values = e.values.replace(',', &comma.to_string());
            let lines = cut(&format!("{}{comma}{values}{end}", e.type_number), 64);
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
            2 * self.entities.len()
        );
        file + &directory + &parameter + &format!("{totals:<72}T{:>7}\n", 1)
    }
}

/// Numbers as values of an entity, with all their digits.
pub fn values(numbers: &[f64]) -> String {
    let text: Vec<String> = numbers.iter().map(|x| format!("{x:?}")).collect();
    text.join(",")
}
