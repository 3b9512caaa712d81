//! Changes an IGES file entity by entity and writes it as a sound file again: records of 80 columns, numbered and counted.
//!
//! A change of bytes hardly ever leaves a file whose sequence numbers and pointers are right, so what stands behind them
//! (conics, revolutions, trims, solids, subfigures) is reached by this one.

use std::sync::Mutex;

/// Entities seen so far, of which some are added to other files.
static POOL: Mutex<Vec<Entity>> = Mutex::new(Vec::new());
const MOST_IN_POOL: usize = 400;
const MOST_ENTITIES: usize = 200;

/// Fields of the first and second line of a directory entry that can be changed: type, matrix, status, form.
#[derive(Clone, Debug)]
struct Entity {
    type_number: i64,
    matrix: i64,
    status: String,
    form: i64,
    label: String,
    values: Vec<String>,
}

struct File {
    global: Vec<String>,
    entities: Vec<Entity>,
}

/// A linear congruential generator with a permuted output.
struct Dice(u64);

impl Dice {
    fn below(&mut self, n: usize) -> usize {
        self.0 = (self.0)
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let word = (self.0 >> ((self.0 >> 59) + 5)) ^ self.0 >> 33;
        (word % n.max(1) as u64) as usize
    }

    fn one_of<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[self.below(list.len())]
    }
}

/// Types that mean something to the reader.
const TYPES: [i64; 44] = [
    0, 100, 102, 104, 106, 108, 110, 112, 114, 116, 118, 120, 122, 123, 124, 126, 128, 130, 140,
    141, 142, 143, 144, 158, 160, 164, 186, 190, 192, 194, 196, 198, 308, 402, 406, 408, 430, 502,
    504, 508, 510, 514, 314, 212,
];
const CURVES: [i64; 9] = [100, 102, 104, 106, 110, 112, 126, 130, 142];
const SURFACES: [i64; 12] = [108, 114, 118, 120, 122, 128, 140, 190, 192, 194, 196, 198];
const FORMS: [i64; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 13, 63, 15, -1];
const NUMBERS: [&str; 42] = [
    "0",
    "1",
    "2",
    "3",
    "4",
    "5",
    "-1",
    "10",
    "100",
    "65536",
    "99999999",
    "2147483647",
    "-2147483648",
    "9223372036854775807",
    "0.",
    "1.",
    "-1.",
    "0.5",
    "-0.5",
    "2.",
    "1.E-3",
    "1.E-9",
    "1.E-17",
    "1.E-300",
    "5.E-324",
    "1.E6",
    "1.E17",
    "1.E155",
    "1.E300",
    "-1.E308",
    "1.D0",
    "3.14159265358979",
    "6.28318530717959",
    "-6.28318530717959",
    "6.2831853",
    "3.1415927",
    "1.5707963267948966",
    "0.707106781186548",
    "",
    "1HA",
    "0.9999999999",
    "1.0000000001",
];
const STATUS: [&str; 8] = [
    "00000000", "00010000", "00010500", "01000000", "00020000", "00000200", "00030000", "00010001",
];

/// Replaces `data[..size]` by a changed file and returns its size. What is no IGES file becomes one.
pub fn mutate(data: &mut [u8], size: usize, max_size: usize, seed: u32) -> usize {
    let mut dice = Dice(u64::from(seed) ^ 0x9e37_79b9_7f4a_7c15);
    dice.below(2);
    let mut file = parse(&data[..size]);
    if let Ok(mut pool) = POOL.lock() {
        for entity in &file.entities {
            if pool.len() < MOST_IN_POOL {
                pool.push(entity.clone());
            } else if dice.below(16) == 0 {
                let place = dice.below(MOST_IN_POOL);
                pool[place] = entity.clone();
            }
        }
    }
    for _ in 0..1 + dice.below(4) {
        change(&mut file, &mut dice);
    }
    let mut text = write(&file);
    while text.len() > max_size && file.entities.len() > 1 {
        file.entities.truncate(file.entities.len() / 2);
        text = write(&file);
    }
    let size = text.len().min(max_size);
    data[..size].copy_from_slice(&text[..size]);
    size
}

fn change(file: &mut File, dice: &mut Dice) {
    let count = file.entities.len();
    if count == 0 || (count < MOST_ENTITIES && dice.below(12) == 0) {
        let entity = POOL.lock().ok().and_then(|pool| {
            let place = dice.below(pool.len());
            pool.get(place).cloned()
        });
        file.entities.push(entity.unwrap_or(Entity {
            type_number: *dice.one_of(&TYPES),
            matrix: 0,
            status: "00000000".to_owned(),
            form: 0,
            label: String::new(),
            values: vec!["0.".to_owned(); dice.below(12)],
        }));
        return;
    }
    if dice.below(40) == 0 {
        let place = dice.below(file.global.len());
        if let Some(value) = file.global.get_mut(place) {
            *value = new_value(value, count, dice);
        }
        return;
    }
    let k = dice.below(count);
    match dice.below(24) {
        0 => file.entities[k].type_number = *dice.one_of(&TYPES),
        1 => file.entities[k].form = *dice.one_of(&FORMS),
        2 => file.entities[k].status = (*dice.one_of(&STATUS)).to_owned(),
        3 => file.entities[k].matrix = pointer(file, |t| t == 124, dice),
        4 => {
            let (a, b) = (dice.below(count), dice.below(count));
            file.entities.swap(a, b);
        }
        5 if count > 1 && dice.below(2) == 0 => {
            file.entities.pop();
        }
        6 => {
            let other = dice.below(count);
            file.entities[k] = file.entities[other].clone();
        }
        // Another pointer, to an entity of the same kind.
        7..=9 => {
            let values = &file.entities[k].values;
            let pointers: Vec<(usize, i64)> = (values.iter().enumerate())
                .filter_map(|(i, v)| Some((i, v.trim().parse().ok()?)))
                .filter(|&(_, p): &(usize, i64)| p % 2 == 1 && p > 0 && p < 2 * count as i64)
                .collect();
            if pointers.is_empty() {
                return;
            }
            let (i, old) = *dice.one_of(&pointers);
            let old = file.entities[(old / 2) as usize].type_number;
            let kind: &[i64] = if CURVES.contains(&old) {
                &CURVES
            } else if SURFACES.contains(&old) {
                &SURFACES
            } else {
                &TYPES
            };
            let new = match dice.below(4) {
                0 => pointer(file, |_| true, dice),
                1 => -pointer(file, |t| kind.contains(&t), dice),
                _ => pointer(file, |t| kind.contains(&t), dice),
            };
            file.entities[k].values[i] = new.to_string();
        }
        10 => {
            let values = &mut file.entities[k].values;
            let (i, n) = (dice.below(values.len()), 1 + dice.below(8));
            let copy: Vec<String> = values.iter().skip(i).take(n).cloned().collect();
            values.splice(i..i, copy);
        }
        11 => {
            let values = &mut file.entities[k].values;
            let i = dice.below(values.len());
            let end = (i + 1 + dice.below(4)).min(values.len());
            values.drain(i.min(end)..end);
        }
        12 => {
            let values = &mut file.entities[k].values;
            let (i, j) = (dice.below(values.len()), dice.below(values.len()));
            if i < values.len() {
                values.swap(i, j);
            }
        }
        // All reals of the entity by the same factor.
        13 => {
            let factor = *dice.one_of(&[0.0, 1e-9, 1e-3, -1.0, 1e3, 1e9, 1e150, 1e-150]);
            for value in &mut file.entities[k].values {
                if value.contains('.')
                    && let Ok(x) = value.trim().replace('D', "E").parse::<f64>()
                {
                    *value = real(x * factor);
                }
            }
        }
        _ => {
            let values = &mut file.entities[k].values;
            let i = dice.below(values.len());
            let other = dice.below(values.len());
            let other = values.get(other).cloned().unwrap_or_default();
            if let Some(value) = values.get_mut(i) {
                *value = if dice.below(6) == 0 {
                    other
                } else {
                    new_value(value, count, dice)
                };
            }
        }
    }
}

/// Directory number of an entity of a kind, or 0.
fn pointer(file: &File, kind: impl Fn(i64) -> bool, dice: &mut Dice) -> i64 {
    let list: Vec<i64> = (file.entities.iter().enumerate())
        .filter(|(_, e)| kind(e.type_number))
        .map(|(i, _)| 2 * i as i64 + 1)
        .collect();
    if list.is_empty() {
        0
    } else {
        *dice.one_of(&list)
    }
}

/// A real as a file holds it.
fn real(x: f64) -> String {
    let text = format!("{x:?}").to_uppercase();
    if text.contains('.') {
        text
    } else {
        text.replace('E', ".E")
    }
}

fn new_value(old: &str, entities: usize, dice: &mut Dice) -> String {
    let number = old.trim().replace(['D', 'd'], "E").parse::<f64>();
    match (number, dice.below(8)) {
        (Ok(x), 0) => real(-x),
        (Ok(x), 1) => real(x * *dice.one_of(&[0.5, 2.0, 1e-6, 1e6, 1.0 + 1e-9, 1.0 - 1e-6])),
        (Ok(x), 2) => real(x + *dice.one_of(&[1.0, -1.0, 1e-6, -1e-9, 0.1])),
        (Ok(x), 3) => format!(
            "{}",
            (x as i64).saturating_add(*dice.one_of(&[1, -1, 2, -2]))
        ),
        (_, 4) => format!("{}", 2 * dice.below(entities) + 1),
        _ => (*dice.one_of(&NUMBERS)).to_owned(),
    }
}

/// What can be made out of a file's records; damage is passed over.
fn parse(bytes: &[u8]) -> File {
    let (mut global, mut directory) = (Vec::new(), Vec::new());
    let mut parameter: std::collections::HashMap<i64, String> = Default::default();
    for line in bytes.split(|&b| b == b'\n').filter(|l| l.len() >= 73) {
        let columns =
            |from: usize, to: usize| String::from_utf8_lossy(&line[from..to]).into_owned();
        match line[72] {
            b'G' => global.push(columns(0, 72)),
            b'D' => directory.push(columns(0, 72)),
            b'P' => {
                let owner = columns(64, 72).trim().parse().unwrap_or(0);
                *parameter.entry(owner).or_default() += &columns(0, 64);
            }
            _ => {}
        }
    }
    let mut entities = Vec::new();
    for (k, lines) in directory.chunks_exact(2).enumerate() {
        let field = |line: usize, i: usize| {
            let text: String = lines[line].chars().skip(8 * i).take(8).collect();
            text.trim().to_owned()
        };
        let text = parameter.remove(&(2 * k as i64 + 1)).unwrap_or_default();
        let text = text
            .rsplit_once(';')
            .map_or(text.as_str(), |(text, _)| text);
        entities.push(Entity {
            type_number: field(0, 0).parse().unwrap_or(0),
            matrix: field(0, 6).parse().unwrap_or(0),
            status: field(0, 8),
            form: field(1, 4).parse().unwrap_or(0),
            label: field(1, 7),
            values: text
                .split(',')
                .skip(1)
                .map(|v| v.trim().to_owned())
                .collect(),
        });
    }
    let global = global.concat();
    let global = global.trim_end().trim_end_matches(';');
    let sound = global.starts_with("1H,,1H;,");
    File {
        global: (if sound { &global[8..] } else { GLOBAL })
            .split(',')
            .map(str::to_owned)
            .collect(),
        entities,
    }
}

/// Behind the delimiters: millimetres, a resolution of 1e-6.
const GLOBAL: &str = "4Htest,4Htest,1H1,1H1,32,38,6,308,15,,1.,2,2HMM,1,0.01,,1.E-6,";

fn write(file: &File) -> Vec<u8> {
    use std::fmt::Write;
    let cut = |text: &str, width: usize| -> Vec<String> {
        let chars: Vec<char> = text.chars().collect();
        chars.chunks(width).map(|c| c.iter().collect()).collect()
    };
    let mut out = format!("{:<72}S{:>7}\n", "", 1);
    let globals = cut(&format!("1H,,1H;,{};", file.global.join(",")), 72);
    for (i, line) in globals.iter().enumerate() {
        let _ = writeln!(out, "{line:<72}G{:>7}", i + 1);
    }
    let (mut directory, mut parameter) = (String::new(), String::new());
    let mut count = 0;
    for (k, e) in file.entities.iter().enumerate() {
        let text = format!("{},{};", e.type_number, e.values.join(","));
        let (number, lines) = (2 * k + 1, cut(&text, 64));
        let fields = [
            [e.type_number, count + 1, 0, 0, 0, 0, e.matrix, 0],
            [e.type_number, 0, 0, lines.len() as i64, e.form, 0, 0, 0],
        ];
        for (line, fields) in fields.iter().enumerate() {
            for (i, field) in fields.iter().enumerate() {
                let _ = match (line, i) {
                    (1, 5 | 6) => write!(directory, "{:>8}", ""),
                    (1, 7) => write!(directory, "{:>8}", e.label),
                    _ => write!(directory, "{field:>8}"),
                };
            }
            let last = if line == 0 { &e.status } else { "0" };
            let _ = writeln!(directory, "{last:>8}D{:>7}", number + line);
        }
        for line in lines {
            count += 1;
            let _ = writeln!(parameter, "{line:<64}{number:>8}P{count:>7}");
        }
    }
    let totals = format!(
        "S{:>7}G{:>7}D{:>7}P{count:>7}",
        1,
        globals.len(),
        2 * file.entities.len()
    );
    (out + &directory + &parameter + &format!("{totals:<72}T{:>7}\n", 1)).into_bytes()
}
