//! Takes a Markdown text apart: quoted words, links, headings, table cells, command lines.

/// Returns the text between single back-ticks, with its line from 1.
pub fn quoted(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (number, line) in numbered(text) {
        let inside = line.split('`').skip(1).step_by(2);
        found.extend(inside.map(|quoted| (number, quoted.to_owned())));
    }
    found
}

/// Returns the targets of links and pictures outside of fenced code, with their line.
pub fn links(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (number, line) in prose(text) {
        for rest in line.split("](").skip(1) {
            if let Some((target, _)) = rest.split_once(')') {
                found.push((number, target.to_owned()));
            }
        }
    }
    found
}

/// Returns the anchors that the headings of a text make.
pub fn anchors(text: &str) -> Vec<String> {
    let lines = prose(text).into_iter().map(|(_, line)| line);
    let titles = lines.filter(|line| line.starts_with('#'));
    titles
        .map(|line| anchor(line.trim_start_matches('#').trim()))
        .collect()
}

fn anchor(title: &str) -> String {
    let kept = title
        .chars()
        .filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.map(|c| if c == ' ' { '-' } else { c })
        .collect::<String>()
        .to_lowercase()
}

/// Returns the cells of tables with their line.
pub fn cells(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (number, line) in prose(text) {
        let Some(row) = line.trim().strip_prefix('|') else {
            continue;
        };
        let row = row.strip_suffix('|').unwrap_or(row).replace("\\|", "/");
        found.extend(row.split('|').map(|cell| (number, cell.trim().to_owned())));
    }
    found
}

/// Counts the words of a text; two Chinese characters count as a word.
pub fn words(text: &str) -> usize {
    let of = |word: &str| (word.chars().filter(|c| is_han(*c)).count() / 2).max(1);
    text.split_whitespace().map(of).sum()
}

fn is_han(c: char) -> bool {
    ('\u{4e00}'..='\u{9fff}').contains(&c)
}

/// Returns every `relayrig ...` command line, quoted or in fenced code, with its line; joins continued lines. Leaves
/// out a synopsis such as `relayrig [--config DIR] COMMAND`.
pub fn command_lines(text: &str) -> Vec<(usize, String)> {
    let joined = text.replace("\\\n", "");
    let fenced = fenced(&joined)
        .into_iter()
        .map(|(number, line)| (number, line.trim_start_matches("$ ").to_owned()));
    let mut found: Vec<_> = fenced.chain(quoted(&joined)).collect();
    let is_synopsis = |line: &str| line.contains('[') || line.contains("...");
    found.retain(|(_, line)| line.starts_with("relayrig ") && !is_synopsis(line));
    found
}

/// Splits a command line into the words that a shell gives to the program, without its name. A word in capitals
/// alone, such as `LOT`, becomes `1`, which the parser takes for a name and for a number.
pub fn arguments(line: &str) -> Vec<String> {
    let (mut words, mut word, mut quote) = (Vec::new(), None::<String>, None);
    for c in line.chars() {
        match (quote, c) {
            (Some(open), _) if c == open => quote = None,
            (None, '\'' | '"') => {
                quote = Some(c);
                word.get_or_insert_default();
            }
            (None, ' ') => words.extend(word.take()),
            (None, '|' | '<' | '>' | '&' | ';' | '#') => break,
            (_, _) => word.get_or_insert_default().push(c),
        }
    }
    words.extend(word);
    let filled = |word: String| match word.bytes().all(|c| c.is_ascii_uppercase()) {
        true => "1".to_owned(),
        false => word,
    };
    words.into_iter().skip(1).map(filled).collect()
}

fn numbered(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line))
}

/// Lines outside of fenced code.
fn prose(text: &str) -> Vec<(usize, &str)> {
    by_fence(text, false)
}

/// Lines of fenced code.
fn fenced(text: &str) -> Vec<(usize, &str)> {
    by_fence(text, true)
}

fn by_fence(text: &str, wanted: bool) -> Vec<(usize, &str)> {
    let mut inside = false;
    let mut found = Vec::new();
    for (number, line) in numbered(text) {
        if line.trim_start().starts_with("```") {
            inside = !inside;
        } else if inside == wanted {
            found.push((number, line));
        }
    }
    found
}

#[test]
fn a_command_line_is_split_like_a_shell_does() {
    assert_eq!(
        arguments("relayrig bus send --checksum '@11' > out.txt"),
        ["bus", "send", "--checksum", "@11"]
    );
    assert_eq!(
        arguments("relayrig lot hold LOT --reason 'wrong label'"),
        ["lot", "hold", "1", "--reason", "wrong label"]
    );
}

#[test]
fn a_text_is_taken_apart() {
    let text = "# A b\n| `x` | two words |\n[to](#a-b)\n```sh\nrelayrig demo \\\n  --speed 5\n[no](link)\n```\n";
    assert_eq!(links(text), [(3, "#a-b".to_owned())]);
    assert_eq!(anchors(text), ["a-b"]);
    assert_eq!(cells(text)[1], (2, "two words".to_owned()));
    assert_eq!(
        command_lines(text),
        [(5, "relayrig demo   --speed 5".to_owned())]
    );
    assert_eq!(
        (
            words("at most three"),
            words("标准件放在料道最前端"),
            words("")
        ),
        (3, 5, 0)
    );
}
