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
        // Attribute `row` is the form of a message in rows and files, which is English in every language.
        let read = english.iter().filter(|it| **it != "row").copied();
        assert_eq!(
            read.clone().collect::<BTreeSet<_>>(),
            attributes(Lang::Zh, id),
            "{id}"
        );
        for attribute in read.map(Some).chain([None]) {
            let [en, zh] = Lang::ALL.map(|lang| arguments(lang, id, attribute));
            assert_eq!(en, zh, "{id} {attribute:?}");
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
