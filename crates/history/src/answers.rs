//! Answers of people to the prompts of a lot, from the audit of orders.

use super::error::Result;
use super::{Archive, Filter, Moment, OrderChoice};

/// An answer to a prompt.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PromptAnswer {
    /// Time of the answer.
    pub at: Moment,
    /// Number of the run within its lot; `None` outside a run.
    pub run: Option<u32>,
    /// Name of the prompt.
    pub prompt: String,
    /// Name of the choice.
    pub choice: String,
    /// Person who answered.
    pub who: String,
}

impl Archive {
    /// Returns the answers in order of time; lot, run, recipe and time span of the filter select them.
    pub fn answers(&self, filter: &Filter) -> Result<Vec<PromptAnswer>> {
        // Limit and offset of the filter count parts.
        let all = Filter {
            limit: None,
            offset: None,
            ..filter.clone()
        };
        let answers = OrderChoice {
            order: Some("answer".to_owned()),
            ..OrderChoice::default()
        };
        let orders = self.orders(&all, &answers)?.into_iter();
        let taken = orders.filter(|it| it.refused.is_none());
        let member = |it: &serde_json::Value| it.as_str().unwrap_or_default().to_owned();
        Ok(taken
            .map(|it| PromptAnswer {
                at: it.at,
                run: it.run,
                prompt: member(&it.what["prompt"]),
                choice: member(&it.what["choice"]),
                who: it.who,
            })
            .collect())
    }
}
