//! What the runs of a study have in common and in what they differ: series, lines of refinement, names.
use crate::page::number::listed;
use crate::study::record::{Ending, Label, Measured, Record, RunRecord, Spread};
use std::collections::{BTreeMap, BTreeSet};

/// Colours and marker shapes that there are.
pub(crate) const STYLES: usize = 8;

/// How a series looks in all plots.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Style {
    pub colour: usize,
    pub marker: usize,
}

/// Runs that differ in nothing but what makes them finer.
#[derive(Debug, Clone)]
pub(crate) struct Series {
    pub name: String,
    pub style: Style,
    pub runs: Vec<usize>,
}

/// Runs of one series that differ in the size of one choice only, coarse to fine.
#[derive(Debug, Clone)]
pub(crate) struct Line {
    pub series: usize,
    pub runs: Vec<usize>,
    /// All other sizes are the least of the series.
    pub finest: bool,
}

/// Colours tell one choice and markers the rest, where there are more series than colours.
#[derive(Debug, Clone)]
pub(crate) struct Factors {
    /// What the colours mean, in their order.
    pub colours: Vec<String>,
    pub markers: Vec<String>,
}

/// A record with its runs sorted into series.
pub(crate) struct View<'a> {
    pub record: &'a Record,
    /// Places of the choices in which runs differ.
    pub varying: Vec<usize>,
    pub series: Vec<Series>,
    /// Series of every run; none for runs that only references need.
    pub of_run: Vec<Option<usize>>,
    pub factors: Option<Factors>,
}

impl<'a> View<'a> {
    pub fn new(record: &'a Record) -> Self {
        let of_grid = |run: &RunRecord| !run.choices.is_empty() || run.reference.is_none();
        let grid: Vec<usize> = (0..record.runs.len())
            .filter(|&i| of_grid(&record.runs[i]))
            .collect();
        let values = |c: usize, of: fn(&Label) -> &str| -> BTreeSet<Option<&str>> {
            let name = &record.choices[c];
            grid.iter()
                .map(|&i| record.runs[i].choices.get(name).map(of))
                .collect()
        };
        let choices = 0..record.choices.len();
        let varying: Vec<usize> = (choices.clone())
            .filter(|&c| values(c, |l| &l.text).len() > 1)
            .collect();
        let telling: Vec<usize> = choices
            .filter(|&c| values(c, |l| &l.series).len() > 1)
            .collect();
        let mut view = View {
            record,
            varying,
            series: Vec::new(),
            of_run: vec![None; record.runs.len()],
            factors: None,
        };
        let mut places: BTreeMap<Vec<Option<&str>>, usize> = BTreeMap::new();
        for &i in &grid {
            let key: Vec<Option<&str>> = telling
                .iter()
                .map(|&c| view.label(i, c).map(|l| l.series.as_str()))
                .collect();
            let name = view.series_name(&key, &telling);
            let s = *places.entry(key).or_insert_with(|| {
                let style = Style {
                    colour: view.series.len() % STYLES,
                    marker: view.series.len() % STYLES,
                };
                view.series.push(Series {
                    name,
                    style,
                    runs: Vec::new(),
                });
                view.series.len() - 1
            });
            view.series[s].runs.push(i);
            view.of_run[i] = Some(s);
        }
        if view.series.len() > STYLES {
            view.factor(&places, &telling);
        }
        view
    }

    fn series_name(&self, key: &[Option<&str>], telling: &[usize]) -> String {
        let parts: Vec<String> = telling
            .iter()
            .zip(key)
            .filter_map(|(&c, part)| part.map(|text| self.say(c, text)))
            .filter(|part| !part.is_empty())
            .collect();
        if key.is_empty() {
            "runs".to_string()
        } else if parts.is_empty() {
            "as in the scene".to_string()
        } else {
            parts.join(", ")
        }
    }

    /// Colours for the first choice that has several series, markers for all the others together.
    fn factor(&mut self, places: &BTreeMap<Vec<Option<&str>>, usize>, telling: &[usize]) {
        let mut keys: Vec<(&Vec<Option<&str>>, usize)> =
            places.iter().map(|(k, &s)| (k, s)).collect();
        keys.sort_by_key(|k| k.1);
        let place = |names: &mut Vec<String>, name: String| {
            let found = names.iter().position(|n| *n == name);
            found.unwrap_or_else(|| {
                names.push(name);
                names.len() - 1
            })
        };
        let (mut colours, mut markers) = (Vec::new(), Vec::new());
        let mut styles = Vec::new();
        for (key, s) in keys {
            let first = match key[0] {
                Some(_) => self.series_name(&key[..1], &telling[..1]),
                None => format!("{} as in the scene", self.record.choices[telling[0]]),
            };
            let rest = self.series_name(&key[1..], &telling[1..]);
            let style = Style {
                colour: place(&mut colours, first),
                marker: place(&mut markers, rest),
            };
            styles.push((s, style));
        }
        // Colours and markers that mean several things are of no use: then the two together tell series apart.
        let few = telling.len() > 1 && colours.len() <= STYLES && markers.len() <= STYLES;
        for (s, style) in styles {
            self.series[s].style = if few {
                style
            } else {
                Style {
                    colour: s % STYLES,
                    marker: (s + s / STYLES) % STYLES,
                }
            };
        }
        if few {
            self.factors = Some(Factors { colours, markers });
        }
    }

    pub fn run(&self, i: usize) -> &'a RunRecord {
        &self.record.runs[i]
    }

    pub fn label(&self, run: usize, choice: usize) -> Option<&'a Label> {
        self.record.runs[run]
            .choices
            .get(&self.record.choices[choice])
    }

    pub fn measured(&self, run: usize, quantity: usize) -> Option<&'a Measured> {
        self.record.runs[run].measured.get(quantity)
    }

    /// Runs of the grids that reached their end.
    pub fn done(&self) -> Vec<usize> {
        (0..self.of_run.len())
            .filter(|&i| self.of_run[i].is_some() && self.run(i).ending == Ending::Done)
            .collect()
    }

    /// Error of a run in a quantity, where it is a number and the run is not the reference itself.
    pub fn error(&self, run: usize, quantity: usize) -> Option<f64> {
        let error = self.measured(run, quantity)?.error?;
        let itself = error == 0.0 && self.run(run).reference.is_some();
        (error.is_finite() && error >= 0.0 && !itself).then_some(error)
    }

    pub fn value(&self, run: usize, quantity: usize) -> Option<f64> {
        let value = self.measured(run, quantity)?.value?;
        value.is_finite().then_some(value)
    }

    pub fn wall(&self, run: usize) -> Option<Spread> {
        let wall = self.run(run).wall?;
        (wall.median.is_finite() && wall.median > 0.0).then_some(wall)
    }

    pub fn style(&self, run: usize) -> Style {
        let series = self.of_run[run].map(|s| self.series[s].style);
        series.unwrap_or(Style {
            colour: STYLES - 1,
            marker: 0,
        })
    }

    /// A label that can stand without the name of its choice: "bilinear", but "step 0.1".
    pub fn say(&self, choice: usize, text: &str) -> String {
        let text = text.trim().replace(", ", " ");
        let bare =
            ["true", "false", "on", "off", "none", "null", "yes", "no"].contains(&text.as_str());
        let number = text.starts_with(|c: char| c.is_ascii_digit() || ".-−".contains(c));
        if !text.is_empty() && !number && !bare {
            text
        } else if text.is_empty() {
            String::new()
        } else {
            format!("{} {text}", self.record.choices[choice])
        }
    }

    /// In what a run differs from others, part by part; its folder where it differs in nothing.
    pub fn parts(&self, run: usize) -> Vec<String> {
        let parts: Vec<String> = self
            .varying
            .iter()
            .filter_map(|&c| self.label(run, c).map(|l| self.say(c, &l.text)))
            .filter(|part| !part.is_empty())
            .collect();
        if parts.is_empty() {
            vec![self.run(run).id.clone()]
        } else {
            parts
        }
    }

    /// "bilinear chord 0.1, H8 10 x 10".
    pub fn name(&self, run: usize) -> String {
        match (&self.run(run).reference, self.of_run[run]) {
            (Some(reference), None) => format!("reference {reference}: {}", self.run(run).id),
            _ => self.parts(run).join(", "),
        }
    }

    /// " with bilinear chord 0.1 and H8 10 x 10"; nothing where runs do not differ.
    pub fn with(&self, run: usize) -> String {
        if self.varying.is_empty() {
            return String::new();
        }
        format!(" with {}", listed(&self.parts(run)))
    }

    /// Choices with sizes, of which some series has several.
    pub fn sized(&self) -> Vec<usize> {
        let several = |&c: &usize| self.lines(c).iter().any(|line| line.runs.len() > 1);
        self.varying.iter().copied().filter(several).collect()
    }

    /// Runs that got through, by what they share besides the size of a choice.
    pub fn lines(&self, choice: usize) -> Vec<Line> {
        let mut groups: Vec<(Vec<Option<&str>>, Line, f64)> = Vec::new();
        for i in self.done() {
            let (Some(series), Some(_)) = (self.of_run[i], self.size(i, choice)) else {
                continue;
            };
            let others = || (0..self.record.choices.len()).filter(|&c| c != choice);
            let key: Vec<Option<&str>> = others()
                .map(|c| self.label(i, c).map(|l| l.text.as_str()))
                .collect();
            let found = groups
                .iter()
                .position(|g| g.1.series == series && g.0 == key);
            match found {
                Some(g) => groups[g].1.runs.push(i),
                None => {
                    let fineness = others().filter_map(|c| self.size(i, c)).map(f64::ln).sum();
                    let line = Line {
                        series,
                        runs: vec![i],
                        finest: false,
                    };
                    groups.push((key, line, fineness));
                }
            }
        }
        for s in 0..self.series.len() {
            let of_series = || groups.iter().enumerate().filter(|g| g.1.1.series == s);
            let finest = of_series()
                .min_by(|a, b| a.1.2.total_cmp(&b.1.2))
                .map(|g| g.0);
            if let Some(g) = finest {
                groups[g].1.finest = true;
            }
        }
        let mut lines: Vec<Line> = groups.into_iter().map(|g| g.1).collect();
        for line in &mut lines {
            let size = |&i: &usize| self.size(i, choice).unwrap_or(0.0);
            line.runs.sort_by(|a, b| size(b).total_cmp(&size(a)));
        }
        lines
    }

    /// The size of a run in a choice, where it is a positive number.
    pub fn size(&self, run: usize, choice: usize) -> Option<f64> {
        let size = self.label(run, choice)?.size?;
        (size.is_finite() && size > 0.0).then_some(size)
    }

    /// Runs of the same series that are nowhere coarser, and somewhere finer. More slave points or a stiffer penalty do not count
    /// as finer: they change what is asked of a mesh, and may ask too much.
    pub fn refinements(&self, run: usize) -> Vec<usize> {
        let choices: Vec<usize> = (0..self.record.choices.len())
            .filter(|&c| !matches!(&*self.record.choices[c], "points" | "penalty" | "tolerance"))
            .collect();
        let same = |i: usize, c: usize| match choices.contains(&c) {
            true => self.label(i, c).map(|l| &l.series) == self.label(run, c).map(|l| &l.series),
            false => self.label(i, c).map(|l| &l.text) == self.label(run, c).map(|l| &l.text),
        };
        let ratio = |i: usize, c: usize| match (self.size(i, c), self.size(run, c)) {
            (Some(other), Some(own)) => other / own,
            _ => 1.0,
        };
        (self.done().into_iter())
            .filter(|&i| (0..self.record.choices.len()).all(|c| same(i, c)))
            .filter(|&i| choices.iter().all(|&c| ratio(i, c) <= 1.0))
            .filter(|&i| choices.iter().any(|&c| ratio(i, c) < 1.0))
            .collect()
    }

    /// For every series the lines along the choice that changes most what `of` gives.
    pub fn lines_along(&self, of: impl Fn(usize) -> Option<f64>) -> Vec<Line> {
        let mut best: Vec<(f64, Vec<Line>)> = vec![(1.0, Vec::new()); self.series.len()];
        for c in self.sized() {
            let lines = self.lines(c);
            for (s, best) in best.iter_mut().enumerate() {
                let of_series: Vec<Line> =
                    lines.iter().filter(|l| l.series == s).cloned().collect();
                let change = of_series
                    .iter()
                    .map(|l| spread(&l.runs, &of))
                    .fold(1.0, f64::max);
                if change > best.0 * 1.000_001 {
                    *best = (change, of_series);
                }
            }
        }
        best.into_iter().flat_map(|b| b.1).collect()
    }

    /// What sizes of a choice are called, e.g. "chord": the word that labels have between series and number.
    pub fn size_word(&self, choice: usize) -> Option<String> {
        let name = &self.record.choices[choice];
        let mut word: Option<String> = None;
        for i in self.done() {
            let Some(label) = self.label(i, choice).filter(|l| l.size.is_some()) else {
                continue;
            };
            let rest = finer(label);
            let one_over = of_penalty(label);
            let letters: String = rest.chars().take_while(|c| c.is_alphabetic()).collect();
            let one = if one_over {
                "1/penalty".to_owned()
            } else if label.series == *name && rest.parse::<f64>().is_ok() {
                name.clone()
            } else {
                letters
            };
            if one.len() < 3 || word.as_ref().is_some_and(|w| *w != one) {
                return None;
            }
            word = Some(one);
        }
        word
    }

    /// What sizes of a choice are, for axes.
    pub fn size_meaning(&self, choice: usize) -> String {
        let name = &self.record.choices[choice];
        match (self.size_word(choice), name.as_str()) {
            (Some(word), _) if word == *name || word.starts_with("1/") => word,
            (Some(word), _) => format!("{word} of {name}"),
            (None, "shell") => "relative element size".to_string(),
            (None, "points") => "1/n of the points".to_string(),
            (None, _) => format!("size of {name}"),
        }
    }
}

/// The label is of a penalty, whose size is the inverse.
fn of_penalty(label: &Label) -> bool {
    if !matches!(label.series.as_str(), "penalty" | "automatic penalty") {
        return false;
    }
    let mut words = label.text.split(' ');
    let factor = words.find_map(|w| w.parse::<f64>().ok()).unwrap_or(1.0);
    (label.size).is_some_and(|size| (size * factor - 1.0).abs() < 1e-9)
}

/// What a label says of its size, e.g. "chord 0.1": what follows the name of its series. All of it where the two differ
/// otherwise.
pub(crate) fn finer(label: &Label) -> &str {
    match label.text.strip_prefix(&label.series) {
        Some(rest) => rest.trim_matches([' ', ',']),
        None if label.series.contains(" by ") => {
            let after = label.text.split_once(", ").map(|parts| parts.1);
            after.unwrap_or(&label.text)
        }
        None => &label.text,
    }
}

/// Greatest over least.
fn spread(runs: &[usize], of: impl Fn(usize) -> Option<f64>) -> f64 {
    let values = runs.iter().filter_map(|&i| of(i)).filter(|v| *v > 0.0);
    let (low, high) = values.fold((f64::INFINITY, 0.0f64), |b, v| (b.0.min(v), b.1.max(v)));
    if high > low { high / low } else { 1.0 }
}
