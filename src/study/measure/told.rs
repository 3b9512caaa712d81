//! What the user should know about a quantity, with the runs it holds for.

/// Runs named in one warning; more are counted.
const NAMED: usize = 8;

/// Warnings of a quantity: what many runs share is said once.
pub(super) struct Told {
    quantity: String,
    said: Vec<(String, Vec<String>)>,
}

impl Told {
    pub fn new(quantity: &str) -> Told {
        Told {
            quantity: quantity.to_string(),
            said: Vec::new(),
        }
    }

    /// Holds for a run; `detail` is what differs from run to run.
    pub fn run(&mut self, text: &str, id: &str, detail: Option<&str>) {
        let who = match detail {
            Some(detail) => format!("`{id}` ({detail})"),
            None => format!("`{id}`"),
        };
        let names = self.names(text);
        if !names.contains(&who) {
            names.push(who);
        }
    }

    /// Holds whatever the run.
    pub fn all(&mut self, text: &str) {
        self.names(text);
    }

    fn names(&mut self, text: &str) -> &mut Vec<String> {
        let place = match self.said.iter().position(|(said, _)| said == text) {
            Some(place) => place,
            None => {
                self.said.push((text.to_string(), Vec::new()));
                self.said.len() - 1
            }
        };
        &mut self.said[place].1
    }

    /// A sentence for each thing that was told.
    pub fn into_words(self) -> Vec<String> {
        let quantity = self.quantity;
        (self.said.into_iter())
            .map(|(text, names)| match names.len() {
                0 => format!("quantity `{quantity}`: {text}"),
                n if n > NAMED => format!(
                    "quantity `{quantity}`: {text}: {} and {} more",
                    names[..NAMED].join(", "),
                    n - NAMED
                ),
                _ => format!("quantity `{quantity}`: {text}: {}", names.join(", ")),
            })
            .collect()
    }
}
