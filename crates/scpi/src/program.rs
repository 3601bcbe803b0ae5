//! Programs: commands and queries that belong together. Their values are delivered together or not at all.

use super::reply::Form;
use units::Span;

/// One message to the instrument, without its end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Step {
    /// A command without reply.
    Send(String),
    /// A query. It may be repeated, so it must not take something away that a second one would miss.
    Ask {
        /// Text of the query; one query, without `;`.
        command: String,
        /// Form of its reply.
        form: Form,
        /// Time allowed for the reply; `None` for the usual time of the link.
        limit: Option<Span>,
        /// Reply that proves a setting; any other one fails the program.
        expect: Option<String>,
    },
}

impl Step {
    /// Returns a query with the usual time.
    pub fn ask(command: &str, form: Form) -> Self {
        let (limit, expect) = (None, None);
        Self::Ask {
            command: command.to_owned(),
            form,
            limit,
            expect,
        }
    }

    /// Returns a command.
    pub fn send(command: &str) -> Self {
        Self::Send(command.to_owned())
    }
}

/// Steps in their order. The values of a program are those of its queries without `expect`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Program {
    /// The steps.
    pub steps: Vec<Step>,
}

impl Program {
    /// Returns the longest time for its steps when a query has `usual` and may be asked twice.
    pub(crate) fn longest(&self, usual: Span) -> Span {
        self.steps.iter().fold(Span(0), |sum, step| match step {
            Step::Send(_) => sum + usual,
            Step::Ask { limit, .. } => {
                let limit = limit.unwrap_or(usual);
                sum + limit + limit
            }
        })
    }
}
