//! Files whose keywords are in small letters, which the standard does not have.

/// The same bytes with capitals outside of strings, binary values and comments: every place stays where it is.
pub fn capitals(bytes: &[u8]) -> Vec<u8> {
    let mut out = bytes.to_vec();
    let mut within = None;
    let mut at = 0;
    while at < out.len() {
        match (within, out[at]) {
            (None, quote @ (b'\'' | b'"')) => within = Some(quote),
            (None, b'/') if out.get(at + 1) == Some(&b'*') => {
                within = Some(b'*');
                at += 1;
            }
            (None, letter) => out[at] = letter.to_ascii_uppercase(),
            (Some(b'*'), b'*') if out.get(at + 1) == Some(&b'/') => {
                within = None;
                at += 1;
            }
            (Some(quote @ (b'\'' | b'"')), sign) if sign == quote => within = None,
            _ => {}
        }
        at += 1;
    }
    out
}

#[cfg(test)]
mod tests {
    #[test]
    fn strings_and_comments_keep_their_letters() {
        let text = b"#1=plane('it''s a',$,.t.);/* a 'b* */#2=x(\"0a\",1.e-3);";
        let expected = b"#1=PLANE('it''s a',$,.T.);/* a 'b* */#2=X(\"0a\",1.E-3);";
        assert_eq!(super::capitals(text), expected);
    }
}
