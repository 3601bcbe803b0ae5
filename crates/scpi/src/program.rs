//! Programs: commands and queries that belong together. A link delivers all of their values or none.

use super::reply::Form;
use units::Span;

/// One message to the instrument, without its terminator.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Step {
    /// A command, which has no reply.
    Send(String),
    /// A query. The link may repeat the query, so its reply must not consume what the repetition asks for.
    Ask {
        /// Text of the query; one query, without `;`.
        command: String,
        /// Form of its reply.
        form: Form,
        /// Time allowed for the reply; `None` for the default time of the link.
        limit: Option<Span>,
        /// Expected reply, which proves a setting; any other reply fails the program.
        expect: Option<String>,
    },
}

impl Step {
    /// Returns a query with the default time.
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

/// Steps in order. The values of a program are those of its queries without `expect`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Program {
    /// The steps.
    pub steps: Vec<Step>,
}

impl Program {
    /// Returns the number of its values.
    pub fn values(&self) -> usize {
        let is_value = |step: &&Step| matches!(step, Step::Ask { expect: None, .. });
        self.steps.iter().filter(is_value).count()
    }

    /// Appends the steps of another program, so that one proof ends both.
    pub fn append(&mut self, mut other: Self) {
        self.steps.append(&mut other.steps);
    }

    /// Returns the longest time of all steps together: a message without a limit of its own takes at most `usual`, and
    /// the link may send each query twice.
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
