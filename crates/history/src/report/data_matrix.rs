//! Data Matrix symbol (ECC 200) of a serial number, as a picture for paper.

use super::svg::Svg;
use datamatrix::{DataMatrix, SymbolList};

/// Light border that a scanner needs, modules.
const QUIET: f64 = 1.0;

/// Returns the symbol of `serial` as SVG; `None` for a text that no symbol holds.
pub(super) fn data_matrix(serial: &str) -> Option<String> {
    let symbol = DataMatrix::encode(serial.as_bytes(), SymbolList::default()).ok()?;
    let map = symbol.bitmap();
    let [width, height] = [map.width(), map.height()].map(|it| it as f64 + 2.0 * QUIET);
    let mut svg = Svg::new([width, height]);
    for (x, y) in map.pixels() {
        svg.rect([x as f64 + QUIET, y as f64 + QUIET], [1.0, 1.0], "#000");
    }
    Some(svg.inline())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_symbol_is_read_back() {
        let serial = "L-1122-000017";
        let symbol = DataMatrix::encode(serial.as_bytes(), SymbolList::default()).expect("fits");
        let map = symbol.bitmap();
        let read = DataMatrix::decode(map.bits(), map.width()).expect("readable");
        assert_eq!(read, serial.as_bytes());
        let svg = data_matrix(serial).expect("a picture");
        assert_eq!(svg.matches("<rect").count(), map.pixels().count());
    }
}
