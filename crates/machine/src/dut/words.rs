//! A text of pages and paper in both languages.

use serde::Serialize;

/// One text in both languages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Words {
    /// English.
    pub en: &'static str,
    /// Simplified Chinese.
    pub zh: &'static str,
}

impl Words {
    /// Both texts.
    pub const fn of(en: &'static str, zh: &'static str) -> Self {
        Self { en, zh }
    }

    /// What is written alike in both languages.
    pub const fn same(text: &'static str) -> Self {
        Self { en: text, zh: text }
    }
}
