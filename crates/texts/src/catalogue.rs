//! The English and the Chinese catalogue; the program parses each once.

use crate::Lang;
use fluent_bundle::concurrent::FluentBundle;
use fluent_bundle::{FluentArgs, FluentResource};
use fluent_syntax::ast::{Entry, Expression, InlineExpression, Pattern, PatternElement};
use std::collections::BTreeSet;
use std::sync::LazyLock;
use unic_langid::LanguageIdentifier;

type Bundle = FluentBundle<&'static FluentResource>;
pub(crate) type Text = Pattern<&'static str>;

static EN: LazyLock<FluentResource> =
    LazyLock::new(|| parsed(include_str!("../../../locale/en.ftl")));
static ZH: LazyLock<FluentResource> =
    LazyLock::new(|| parsed(include_str!("../../../locale/zh.ftl")));
static EN_BUNDLE: LazyLock<Bundle> = LazyLock::new(|| bundle("en", &EN));
static ZH_BUNDLE: LazyLock<Bundle> = LazyLock::new(|| bundle("zh-CN", &ZH));

/// A text without arguments, in both languages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Plain {
    /// Id of the text: family and code, for example `bin-coil`.
    pub id: &'static str,
    /// English text.
    pub en: &'static str,
    /// Chinese text.
    pub zh: &'static str,
}

fn parsed(text: &str) -> FluentResource {
    match FluentResource::try_new(text.to_owned()) {
        Ok(resource) => resource,
        Err((_, errors)) => panic!("a catalogue is not valid Fluent: {errors:?}"),
    }
}

fn bundle(tag: &str, resource: &'static FluentResource) -> Bundle {
    let locale: LanguageIdentifier = tag.parse().unwrap_or_default();
    let mut bundle = Bundle::new_concurrent(vec![locale]);
    bundle.set_use_isolating(false);
    let added = bundle.add_resource(resource);
    assert!(added.is_ok(), "an id appears twice: {added:?}");
    bundle
}

fn resource(lang: Lang) -> &'static FluentResource {
    match lang {
        Lang::En => &EN,
        Lang::Zh => &ZH,
    }
}

fn of(lang: Lang) -> &'static Bundle {
    match lang {
        Lang::En => &EN_BUNDLE,
        Lang::Zh => &ZH_BUNDLE,
    }
}

/// Returns true when the English catalogue has the text; a test holds the Chinese catalogue to the same texts.
pub(crate) fn has(id: &str) -> bool {
    EN_BUNDLE.has_message(id)
}

pub(crate) fn pattern(lang: Lang, id: &str, attribute: Option<&str>) -> Option<&'static Text> {
    let message = of(lang).get_message(id)?;
    match attribute {
        None => message.value(),
        Some(name) => Some(message.get_attribute(name)?.value()),
    }
}

pub(crate) fn plain_text(lang: Lang, id: &str, attribute: Option<&str>) -> &'static str {
    let found = pattern(lang, id, attribute).and_then(|it| match it.elements.as_slice() {
        [PatternElement::TextElement { value }] => Some(*value),
        _ => None,
    });
    assert!(
        found.is_some(),
        "no text {id} {attribute:?} without arguments in {lang:?}"
    );
    found.unwrap_or_default()
}

/// Fills in the arguments of a text; `None` when an argument is missing.
pub(crate) fn filled(lang: Lang, pattern: &'static Text, args: &FluentArgs<'_>) -> Option<String> {
    let mut errors = Vec::new();
    let text = of(lang).format_pattern(pattern, Some(args), &mut errors);
    errors.is_empty().then(|| text.into_owned())
}

/// Returns the ids of all texts of a language, in the order of its file.
pub fn ids(lang: Lang) -> impl Iterator<Item = &'static str> {
    resource(lang).entries().filter_map(|entry| match entry {
        Entry::Message(message) => Some(message.id.name),
        _ => None,
    })
}

/// Returns the names of the attributes of a text.
pub fn attributes(lang: Lang, id: &str) -> BTreeSet<&'static str> {
    let message = of(lang).get_message(id);
    let all = message.iter().flat_map(|it| it.attributes());
    all.map(|it| it.id()).collect()
}

/// Returns the names of the arguments that a text uses.
pub(crate) fn used(pattern: &Text) -> impl Iterator<Item = &'static str> {
    let name = |element: &PatternElement<&'static str>| match element {
        PatternElement::Placeable {
            expression: Expression::Inline(InlineExpression::VariableReference { id }),
        } => Some(id.name),
        _ => None,
    };
    pattern.elements.iter().filter_map(name)
}

/// Returns the names of the arguments of a text or attribute; `None` for an unknown text or attribute.
pub fn arguments(lang: Lang, id: &str, attribute: Option<&str>) -> Option<BTreeSet<&'static str>> {
    pattern(lang, id, attribute).map(|pattern| used(pattern).collect())
}

/// Returns every text without arguments, in the order of the English file.
pub fn plain() -> impl Iterator<Item = Plain> {
    let without = |id: &&str| arguments(Lang::En, id, None).is_some_and(|it| it.is_empty());
    ids(Lang::En).filter(without).map(|id| Plain {
        id,
        en: Lang::En.text(id),
        zh: Lang::Zh.text(id),
    })
}

#[cfg(test)]
mod tests;
