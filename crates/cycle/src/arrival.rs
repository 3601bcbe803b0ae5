//! Waits for the first answer of any task of a line or instrument; the answer stays until the next turn takes it.

use std::future::poll_fn;
use std::task::Poll;
use tokio::sync::mpsc::Receiver;

/// Queue of the answers of one task, and the answer that has ended a wait.
pub(super) type Inbox<'a, A> = (&'a mut Receiver<A>, &'a mut Option<A>);

/// Returns the next answer; `None` if there is none.
pub(super) fn next<A>((answers, waiting): Inbox<'_, A>) -> Option<A> {
    waiting.take().or_else(|| answers.try_recv().ok())
}

/// Resolves when an answer has arrived in any inbox; `inbox` returns `None` for a slot without a request.
pub(super) async fn any<S, A>(slots: &mut [S], inbox: impl Fn(&mut S) -> Option<Inbox<'_, A>>) {
    poll_fn(|context| {
        for (answers, waiting) in slots.iter_mut().filter_map(&inbox) {
            if waiting.is_none()
                && let Poll::Ready(answer) = answers.poll_recv(context)
            {
                *waiting = answer;
            }
            if waiting.is_some() {
                return Poll::Ready(());
            }
        }
        Poll::Pending
    })
    .await;
}
