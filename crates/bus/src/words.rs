//! Makes messages for requests and replies: `locale/*.ftl` has a text for every [`Description`] of `dcon`.

use dcon::{Command, Description, Model, Reply, ReplyError};
use texts::{Args, Lang, Message};

/// Returns the message for a request, without its address.
pub fn request(command: &Command) -> Message {
    message("request", command.describe())
}

/// Returns the message for a reply to `command`, or for the reason why the line rejects the reply. With `model`, it
/// separates digital inputs from outputs.
pub fn reply(
    command: &Command,
    outcome: &Result<Reply, ReplyError>,
    model: Option<Model>,
) -> Message {
    match outcome {
        Ok(reply) => message("reply", command.describe_reply(reply, model)),
        Err(reason) => rejection(*reason),
    }
}

/// Returns the text of an exchange: module, request and reply, or only the request when it goes to all modules.
pub(super) fn exchange(
    lang: Lang,
    command: &Command,
    outcome: &Result<Reply, ReplyError>,
    model: Option<Model>,
) -> String {
    let asked = request(command).say(lang);
    let exchange = match command.address() {
        None => Message::new("exchange", "all"),
        Some(address) => Message::new("exchange", "module")
            .with("address", address)
            .with("reply", reply(command, outcome, model).say(lang)),
    };
    exchange.with("asked", asked).say(lang)
}

/// Returns the message for the reason why the line rejects a reply.
pub(super) fn rejection(reason: ReplyError) -> Message {
    message("rejection", reason.describe())
}

fn message(family: &'static str, Description { code, args }: Description) -> Message {
    let fill = |filled: Args, (name, value)| filled.with(name, value);
    Message::of(family, code, args.into_iter().fold(Args::default(), fill))
}
