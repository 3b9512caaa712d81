//! Cards of a bulk data file: fixed fields of 8 or 16 columns, or fields between commas, continued over lines.
use crate::mesh::field::Field;

/// A card: its name in capitals, and its fields. A field that is left out is empty.
#[derive(Debug)]
pub(super) struct Card<'a> {
    pub name: String,
    pub at: Field<'a>,
    pub fields: Vec<Field<'a>>,
}

/// A line cut into fields: the first one says what it is.
struct Line<'a> {
    head: Field<'a>,
    fields: Vec<Field<'a>>,
    /// Fields that a continuation starts after.
    width: usize,
}

/// All cards of the bulk data section, in the order of the file. A file without `BEGIN BULK` has nothing else.
pub(super) fn cards(text: &str) -> Vec<Card<'_>> {
    let begins = |line: &str| {
        let mut words = line.split_whitespace().map(str::to_uppercase);
        words.next().as_deref() == Some("BEGIN")
            && words.next().is_some_and(|w| w.starts_with("BULK"))
    };
    let skipped = text.lines().position(begins).map_or(0, |line| line + 1);
    let mut cards: Vec<Card> = Vec::new();
    for (k, line) in text.lines().enumerate().skip(skipped) {
        // Comments may follow the fields.
        let line = line.split('$').next().unwrap_or_default().trim_end();
        if line.is_empty() {
            continue;
        }
        if line.trim().eq_ignore_ascii_case("ENDDATA") {
            break;
        }
        let Line {
            head,
            fields,
            width,
        } = cut(line, k + 1);
        let continues = head.text.is_empty() || head.text.starts_with(['+', '*']);
        match cards.last_mut() {
            Some(card) if continues => {
                // A line that ends early leaves its last fields empty.
                while !card.fields.len().is_multiple_of(width) {
                    card.fields.push(Field {
                        text: "",
                        ..card.at
                    });
                }
                card.fields.extend(fields);
            }
            _ => cards.push(Card {
                name: head.text.trim_end_matches('*').trim().to_uppercase(),
                at: head,
                fields,
            }),
        }
    }
    cards
}

/// Cuts a line without its comment.
fn cut(line: &str, number: usize) -> Line<'_> {
    if line.contains(',') {
        let mut start = 0;
        let mut fields = line.split(',').map(|part| {
            let field = field(part, number, start);
            start += part.chars().count() + 1;
            field
        });
        let head = fields.next().unwrap_or(field("", number, 0));
        let width = if head.text.ends_with('*') || head.text.starts_with('*') {
            4
        } else {
            8
        };
        // The field after the last one names the continuation.
        return Line {
            head,
            fields: fields.take(width).collect(),
            width,
        };
    }
    let column = |from: usize, width: usize| {
        let mut places = line.char_indices().map(|(i, _)| i).skip(from);
        let Some(start) = places.next() else {
            return field("", number, from);
        };
        let end = places.nth(width - 1).unwrap_or(line.len());
        field(&line[start..end], number, from)
    };
    let head = match line.split_once('\t') {
        // Tabs stand for the start of the next field.
        Some(_) => return tabs(line, number),
        None => column(0, 8),
    };
    let (count, width) = match head.text.ends_with('*') || head.text.starts_with('*') {
        true => (4, 16),
        false => (8, 8),
    };
    let last = line
        .chars()
        .count()
        .saturating_sub(8)
        .div_ceil(width)
        .min(count);
    Line {
        head,
        fields: (0..last).map(|k| column(8 + k * width, width)).collect(),
        width: count,
    }
}

fn tabs(line: &str, number: usize) -> Line<'_> {
    let mut start = 0;
    let mut fields = line.split('\t').map(|part| {
        let field = field(part, number, start);
        start += part.chars().count() + 1;
        field
    });
    let head = fields.next().unwrap_or(field("", number, 0));
    let width = if head.text.ends_with('*') || head.text.starts_with('*') {
        4
    } else {
        8
    };
    Line {
        head,
        fields: fields.take(width).collect(),
        width,
    }
}

fn field(part: &str, line: usize, start: usize) -> Field<'_> {
    let blanks = part.chars().take_while(|c| c.is_whitespace()).count();
    Field {
        text: part.trim(),
        line,
        column: start + blanks + 1,
    }
}

/// A real number in the ways of Nastran: `1.5`, `1.5E-3`, `1.5D-3`, `1.5-3`.
pub(super) fn real(text: &str) -> Option<f64> {
    let plain = text.replace(['d', 'D', 'E'], "e");
    let number = match plain.contains('e') {
        true => plain.parse(),
        false => match plain.rfind(['+', '-']).filter(|&i| i > 0) {
            Some(i) => format!("{}e{}", &plain[..i], &plain[i..]).parse(),
            None => plain.parse(),
        },
    };
    number.ok().filter(|x: &f64| x.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_all_kinds() {
        for (text, value) in [
            ("1.5", 1.5),
            ("-.5", -0.5),
            ("1.", 1.0),
            ("1.5-3", 1.5e-3),
            ("-1.5+3", -1.5e3),
            ("1.5D2", 150.0),
            ("7.0E+1", 70.0),
            ("7.e-1", 0.7),
            ("+2", 2.0),
        ] {
            assert_eq!(real(text), Some(value), "{text}");
        }
        for text in ["", "x", "1.5-", "1e999", "nan", "--1"] {
            assert_eq!(real(text), None, "{text}");
        }
    }

    #[test]
    fn cards_of_all_forms_are_the_same() {
        let forms = [
            "CQUAD8  7       3       11      12      13      14      15      16\n        17      18\n",
            "CQUAD8  7       3       11      12      13      14      15      16      +A\n+A      17      18\n",
            "CQUAD8* 7               3               11              12\n*       13              14              15              16\n\
             *       17              18\n",
            "CQUAD8,7,3,11,12,13,14,15,16\n,17,18\n",
            "cquad8,7,3,11,12,13,14,15,16,+1\n+1,17,18 $ a comment\n",
            "CQUAD8\t7\t3\t11\t12\t13\t14\t15\t16\n\t17\t18\n",
        ];
        for text in forms {
            let cards = cards(text);
            assert_eq!(cards.len(), 1, "{text}");
            let fields: Vec<&str> = cards[0].fields.iter().map(|f| f.text).collect();
            assert_eq!(cards[0].name, "CQUAD8");
            assert_eq!(
                fields,
                ["7", "3", "11", "12", "13", "14", "15", "16", "17", "18"],
                "{text}"
            );
        }
        let cards = cards(forms[0]);
        assert_eq!(
            (cards[0].fields[3].line, cards[0].fields[3].column),
            (1, 33)
        );
        assert_eq!(
            (cards[0].fields[9].line, cards[0].fields[9].column),
            (2, 17)
        );
    }
}
