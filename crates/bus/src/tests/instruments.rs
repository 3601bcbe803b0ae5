//! Links to instruments over scripted streams.

use super::*;
use crate::instrument::{Link, Opener};
use scpi::LinkSettings;

#[test]
fn a_half_written_message_ends_the_connection() {
    in_virtual_time(async {
        let (stalled, _unread) = duplex(4);
        let (open, mut instrument) = duplex(64);
        let mut streams = vec![open, stalled];
        let opener = Opener::Streams(from_streams(move || streams.pop()));
        let settings = LinkSettings::default();
        let mut link = Link::new(opener, settings, Pace::virtual_time(), 1);
        let failure = link.exchange(":SOUR:VOLT 20", None).await.unwrap_err();
        assert_eq!(failure.code(), "disconnected");
        link.exchange("*CLS", None).await.unwrap();
        let mut received = [0; 5];
        instrument.read_exact(&mut received).await.unwrap();
        assert_eq!(&received, b"*CLS\n", "nothing is added to the half message");
    });
}
