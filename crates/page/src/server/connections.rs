//! Open connections, limited in number, so that many idle ones leave room for a screen that gives an order.
//!
//! - Connections from this computer and from other computers have places of their own.
//! - The rank of a connection is what it has sent: no whole request, a request, a request of a valid session.
//! - When all places are taken, a new connection takes the place of the oldest with the lowest rank. Connections of
//!   sessions keep their places: while they hold all places, a new connection ends at once.

use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::oneshot;

/// Places for connections from this computer.
const HERE: usize = 64;
/// Places for connections from other computers: some forty screens with six connections each.
const ELSEWHERE: usize = 256;

/// Rank of a connection by the requests that it has sent, from the lowest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Rank {
    /// No whole request.
    Silent,
    /// A request without a valid session.
    Anonymous,
    /// A request of a valid session.
    Session,
}

/// The places of all connections.
#[derive(Debug)]
pub(super) struct Connections {
    here: Arc<Mutex<Places>>,
    elsewhere: Arc<Mutex<Places>>,
}

impl Default for Connections {
    fn default() -> Self {
        let places = |most| Arc::new(Mutex::new(Places::new(most)));
        Self {
            here: places(HERE),
            elsewhere: places(ELSEWHERE),
        }
    }
}

impl Connections {
    /// Takes a place for a connection from `peer`, and returns it with a future that resolves when another connection
    /// takes the place; `None` when sessions hold all places.
    pub fn take(&self, peer: IpAddr) -> Option<(Place, Lost)> {
        let is_here = peer.to_canonical().is_loopback();
        let places = if is_here { &self.here } else { &self.elsewhere };
        let (number, lost) = locked(places).take()?;
        let places = Arc::clone(places);
        Some((Place { places, number }, lost))
    }
}

/// Resolves when its sender is dropped; no sender ever sends.
pub(super) type Lost = oneshot::Receiver<()>;

/// One of the limited places, held for a connection. Dropping this value frees the place; another connection may take
/// it earlier ([`Lost`]).
#[derive(Debug)]
pub(super) struct Place {
    places: Arc<Mutex<Places>>,
    number: u64,
}

impl Place {
    pub fn rank(&self) -> Rank {
        let places = locked(&self.places);
        let found = places.taken.get(&self.number);
        found.map_or(Rank::Silent, |(rank, _)| *rank)
    }

    /// Raises the rank; a rank that is not higher changes nothing.
    pub fn rise(&self, to: Rank) {
        if let Some((rank, _)) = locked(&self.places).taken.get_mut(&self.number) {
            *rank = to.max(*rank);
        }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        locked(&self.places).taken.remove(&self.number);
    }
}

#[derive(Debug)]
struct Places {
    most: usize,
    next: u64,
    /// Connections by number, oldest first; dropping the sender ends the connection.
    taken: BTreeMap<u64, (Rank, oneshot::Sender<()>)>,
}

impl Places {
    const fn new(most: usize) -> Self {
        Self {
            most,
            next: 0,
            taken: BTreeMap::new(),
        }
    }

    fn take(&mut self) -> Option<(u64, Lost)> {
        if self.taken.len() >= self.most {
            let ranked = self
                .taken
                .iter()
                .map(|(number, (rank, _))| (*rank, *number));
            let (_, least) = ranked.min().filter(|(rank, _)| *rank < Rank::Session)?;
            self.taken.remove(&least);
        }
        let number = self.next;
        self.next += 1;
        let (keep, lost) = oneshot::channel();
        self.taken.insert(number, (Rank::Silent, keep));
        Some((number, lost))
    }
}

/// Locks the places even after another holder panicked, because no panic leaves the places half changed.
fn locked(places: &Mutex<Places>) -> MutexGuard<'_, Places> {
    places.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::net::Ipv4Addr;

    const OTHER: IpAddr = IpAddr::V4(Ipv4Addr::new(192, 0, 2, 7));

    fn is_open(place: &Place) -> bool {
        locked(&place.places).taken.contains_key(&place.number)
    }

    /// Takes all places for other computers; the first connections get these ranks.
    fn full(connections: &Connections, ranks: &[Rank]) -> Vec<Place> {
        let taken: Vec<Place> = (0..ELSEWHERE)
            .map(|_| connections.take(OTHER).unwrap().0)
            .collect();
        for (place, rank) in taken.iter().zip(ranks) {
            place.rise(*rank);
        }
        taken
    }

    #[test]
    fn a_new_connection_replaces_the_oldest_silent_one() {
        let connections = Connections::default();
        let old = full(&connections, &[Rank::Session, Rank::Anonymous]);
        let (new, _) = connections.take(OTHER).unwrap();
        assert!(is_open(&new) && is_open(&old[0]) && is_open(&old[1]));
        assert!(!is_open(&old[2]) && is_open(&old[3]));
    }

    #[test]
    fn sessions_keep_their_places() {
        let connections = Connections::default();
        let mut ranks = [Rank::Session; ELSEWHERE];
        ranks[7] = Rank::Anonymous;
        let old = full(&connections, &ranks);
        let (new, _) = connections.take(OTHER).unwrap();
        assert!(!is_open(&old[7]));
        new.rise(Rank::Session);
        assert!(connections.take(OTHER).is_none());
        drop(new);
        assert!(connections.take(OTHER).is_some());
    }

    #[test]
    fn other_computers_take_no_place_of_this_one() {
        let connections = Connections::default();
        let (screen, _) = connections.take(Ipv4Addr::LOCALHOST.into()).unwrap();
        let mapped = Ipv4Addr::LOCALHOST.to_ipv6_mapped();
        let (second, _) = connections.take(mapped.into()).unwrap();
        let _all = full(&connections, &[]);
        let _more = full(&connections, &[]);
        assert!(is_open(&screen) && is_open(&second));
        assert_eq!(locked(&connections.here).taken.len(), 2);
    }

    #[tokio::test]
    async fn a_replaced_connection_learns_it() {
        let connections = Connections::default();
        let (_old, lost) = connections.take(OTHER).unwrap();
        let _others = full(&connections, &[]);
        assert!(lost.await.is_err());
    }
}
