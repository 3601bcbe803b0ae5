//! Every text that a person reads on the page, on paper and in answers, in English and Chinese.
//!
//! `locale/en.ftl` and `locale/zh.ftl` hold the texts in Fluent: literals and `{ $argument }` only. The id of a text is its
//! family and its code, `alarm-door_open`; what belongs to a text stands in its attributes (`.cause`, `.action`). An id,
//! attribute or argument that is missing is a mistake of this program: an assertion fails.
//!
//! ```
//! use texts::{Lang, Message};
//! assert_eq!(Lang::Zh.text("bin-coil"), "线圈不良箱");
//! let full = Message::new("alarm", "bin_full").with("bin", "coil");
//! assert!(full.say(Lang::En).starts_with("The beam of bin coil stays dark."));
//! ```

mod catalogue;
mod message;

pub use catalogue::{Plain, arguments, attributes, ids, plain};
pub use message::{Args, Message};

use serde::Deserialize;

/// Language of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Lang {
    /// English.
    En,
    /// Simplified Chinese.
    Zh,
}

impl Lang {
    /// Every language.
    pub const ALL: [Self; 2] = [Self::En, Self::Zh];

    /// Tag for the `lang` of a page.
    pub const fn tag(self) -> &'static str {
        match self {
            Self::En => "en",
            Self::Zh => "zh-CN",
        }
    }

    /// The text `id`, which has no arguments.
    pub fn text(self, id: &str) -> &'static str {
        catalogue::plain_text(self, id, None)
    }

    /// The attribute of the text `id`, without arguments.
    pub fn attribute(self, id: &str, attribute: &str) -> &'static str {
        catalogue::plain_text(self, id, Some(attribute))
    }

    /// The name of `code` in its family. A code that the catalogue does not know keeps its own name: a bin that a plant has
    /// named, a key of a file of another system.
    pub fn name<'a>(self, family: &str, code: &'a str) -> &'a str {
        let id = format!("{family}-{code}");
        if catalogue::has(&id) {
            self.text(&id)
        } else {
            code
        }
    }
}
