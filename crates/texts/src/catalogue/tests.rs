//! Tests: both languages have the same texts with the same arguments, made of literals and arguments only.

use super::*;

#[test]
fn both_languages_have_equal_ids_in_order() {
    assert!(ids(Lang::En).eq(ids(Lang::Zh)));
}

#[test]
fn both_languages_have_the_same_attributes_and_arguments() {
    for id in ids(Lang::En) {
        let english = attributes(Lang::En, id);
        // Attribute `row` is the text of a message in rows and files, which are English in every language.
        let read = english.iter().filter(|it| **it != "row").copied();
        assert_eq!(
            read.clone().collect::<BTreeSet<_>>(),
            attributes(Lang::Zh, id),
            "{id}"
        );
        for attribute in read.map(Some).chain([None]) {
            let [en, zh] = Lang::ALL.map(|lang| arguments(lang, id, attribute));
            // Argument `said` is English: the Chinese text has other arguments in its place, or none.
            match en.as_ref().is_some_and(|en| en.contains("said")) {
                true => assert!(zh.is_some_and(|zh| !zh.contains("said")), "{id}"),
                false => assert_eq!(en, zh, "{id} {attribute:?}"),
            }
        }
    }
}

#[test]
fn a_text_is_made_of_literals_and_arguments_only() {
    let is_simple = |element: &PatternElement<&str>| match element {
        PatternElement::TextElement { .. } => true,
        PatternElement::Placeable { expression } => matches!(
            expression,
            Expression::Inline(
                InlineExpression::VariableReference { .. } | InlineExpression::StringLiteral { .. }
            )
        ),
    };
    for lang in Lang::ALL {
        for entry in resource(lang).entries() {
            let Entry::Message(message) = entry else {
                assert!(matches!(
                    entry,
                    Entry::Comment(_) | Entry::GroupComment(_) | Entry::ResourceComment(_)
                ));
                continue;
            };
            let attributes = message.attributes.iter().map(|it| &it.value);
            let mut all = message.value.iter().chain(attributes);
            assert!(
                all.all(|it| it.elements.iter().all(is_simple)),
                "{}",
                message.id.name
            );
        }
    }
}

#[test]
fn an_english_text_has_no_chinese_in_it() {
    let cjk =
        |c: char| ('\u{3000}'..='\u{9fff}').contains(&c) || ('\u{ff00}'..='\u{ffef}').contains(&c);
    let english = include_str!("../../../../locale/en.ftl");
    let lines = english.lines().filter(|it| it.contains(cjk));
    assert_eq!(
        lines.collect::<Vec<_>>(),
        [format!(
            "other_language = {}",
            Lang::En.text("other_language")
        )]
    );
}

/// Returns every literal piece of the Chinese texts, without commands in backquotes, with the id of its text.
fn chinese() -> Vec<(&'static str, String)> {
    let mut all = Vec::new();
    for entry in resource(Lang::Zh).entries() {
        let Entry::Message(message) = entry else {
            continue;
        };
        let attributes = message.attributes.iter().map(|it| &it.value);
        let elements = (message.value.iter().chain(attributes)).flat_map(|it| &it.elements);
        for element in elements {
            let PatternElement::TextElement { value } = element else {
                continue;
            };
            let outside: Vec<&str> = value.split('`').step_by(2).collect();
            all.push((message.id.name, outside.join(" ")));
        }
    }
    all
}

#[test]
fn chinese_texts_have_full_width_punctuation() {
    let is_decimal = |text: &str, at: usize| {
        let digit = |it: Option<&u8>| it.is_some_and(u8::is_ascii_digit);
        digit(text.as_bytes().get(at + 1)) && at > 0 && digit(text.as_bytes().get(at - 1))
    };
    let mut broken = Vec::new();
    for (id, text) in chinese() {
        let half = text.char_indices().find(|(at, c)| match c {
            '.' => !is_decimal(&text, *at),
            other => ",;:?!()\"'<>[]".contains(*other) && !text.contains("< 1 mA"),
        });
        broken.extend(half.map(|(_, c)| format!("{id}: {c}")));
    }
    assert_eq!(broken, Vec::<String>::new());
}

/// Latin words that a Chinese text may contain: units, symbols of statistics and metrology, names, keys, codes, columns
/// of files.
const LATIN: [&str; 49] = [
    "A",
    "B",
    "V",
    "mV",
    "mA",
    "mm",
    "ms",
    "min",
    "s",
    "U",
    "k",
    "p",
    "x",
    "y",
    "z",
    "I",
    "MR",
    "R",
    "X",
    "Cp",
    "Cpk",
    "Ppk",
    "OEE",
    "Bissell",
    "SHA-256",
    "CSV",
    "I-7017F",
    "English",
    "Ctrl",
    "Shift",
    "part",
    "operator",
    "trial",
    "value",
    "GRR",
    "Welch",
    "Brown-Forsythe",
    "Hz",
    "INIT",
    "Modbus",
    "RTU",
    "DCON",
    "TTL",
    "CR",
    "ASCII",
    "GPIB",
    "SCPI",
    "MOSFET",
    "PID",
];

#[test]
fn chinese_texts_have_no_latin_words_but_codes() {
    let mut broken = Vec::new();
    for (id, text) in chinese() {
        let words = text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '-'));
        let words = words.filter(|it| it.starts_with(|c: char| c.is_ascii_alphabetic()));
        let foreign = words.filter(|it| !LATIN.contains(it));
        broken.extend(foreign.map(|it| format!("{id}: {it}")));
    }
    assert_eq!(broken, Vec::<String>::new());
}

#[test]
fn one_thing_has_one_chinese_term() {
    const REPLACED: [&str; 10] = [
        "急止",
        "扣留",
        "擒纵",
        "分拣",
        "料仓",
        "零件",
        "工位",
        "首发",
        "自相关",
        "处方",
    ];
    let mut broken = Vec::new();
    for (id, text) in chinese() {
        let old = REPLACED.iter().filter(|it| text.contains(**it));
        broken.extend(old.map(|it| format!("{id}: {it}")));
    }
    assert_eq!(broken, Vec::<String>::new());
}
