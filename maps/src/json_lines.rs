//! Lines of a JSON file's elements, so that a fault can say where.

/// Line (from 1) of each object in the array under a top-level key.
///
/// A light scan beside the real parser: it knows strings and brackets and is only used for messages.
pub(crate) fn object_lines(text: &str, key: &str) -> Vec<usize> {
    let (mut line, mut depth) = (1_usize, 0_usize);
    let (mut in_string, mut escaped) = (false, false);
    let mut word = String::new();
    let mut inside = false;
    let mut lines = Vec::new();
    for c in text.chars() {
        if c == '\n' {
            line += 1;
        }
        if in_string {
            match c {
                _ if escaped => escaped = false,
                '\\' => escaped = true,
                '"' => in_string = false,
                _ if depth == 1 => word.push(c),
                _ => {}
            }
            continue;
        }
        match c {
            '"' => {
                in_string = true;
                if depth == 1 {
                    word.clear();
                }
            }
            '{' | '[' => {
                inside |= depth == 1 && c == '[' && word == key;
                if inside && depth == 2 && c == '{' {
                    lines.push(line);
                }
                depth += 1;
            }
            '}' | ']' => {
                depth = depth.saturating_sub(1);
                inside &= depth > 1;
            }
            _ => {}
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_object_has_the_line_where_it_begins() {
        let text = "{\"graph\": {\"nodes\": [{}]},\n \"nodes\": [\n {\"id\": \"a{[\\\"\",\n \"pos\": [1, 2]}, {\"x\": {}},\n\n {}],\n\"links\": [ {} ]}";
        assert_eq!(object_lines(text, "nodes"), [3, 4, 6]);
        assert_eq!(object_lines(text, "links"), [7]);
        assert!(object_lines(text, "edges").is_empty());
    }
}
