//! Data Matrix symbol (ECC 200) of a serial number, as a picture for paper.

use super::svg::Svg;
use datamatrix::{DataMatrix, SymbolList};

/// Light border that a scanner needs, modules.
const QUIET: f64 = 1.0;

/// Returns the symbol of `serial` as SVG; `None` for a text that no symbol holds. A text beyond Latin-1 is marked as
/// UTF-8 (ECI 26).
pub(super) fn data_matrix(serial: &str) -> Option<String> {
    let symbol = DataMatrix::encode_str(serial, SymbolList::default()).ok()?;
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
    #![allow(clippy::unwrap_used)]
    use super::*;
    use datamatrix::DecodingError;
    use datamatrix::data::{DataDecodingError, decode_str};

    /// Returns the numbers after each occurrence of `name="`, rounded down.
    fn numbers<'a>(svg: &'a str, name: &'a str) -> impl Iterator<Item = usize> + 'a {
        let pieces = svg.split(name).skip(1);
        pieces.map(|it| it.split(['.', '"']).next().unwrap().parse().unwrap())
    }

    /// Reads the modules of the picture as a scanner does.
    fn read(svg: &str) -> Result<Vec<u8>, DecodingError> {
        let size = svg
            .split(['"', ' '])
            .skip_while(|it| !it.starts_with("viewBox"));
        let size: Vec<usize> = size.skip(3).take(2).map(|it| it.parse().unwrap()).collect();
        let [width, height] = [size[0] - 2, size[1] - 2];
        let dark: Vec<_> = numbers(svg, " x=\"").zip(numbers(svg, " y=\"")).collect();
        let bits = (0..width * height).map(|at| dark.contains(&(at % width + 1, at / width + 1)));
        DataMatrix::decode(&bits.collect::<Vec<_>>(), width)
    }

    #[test]
    fn a_drawn_symbol_is_read_back() {
        let serial = "L-1122-000017";
        let drawn = data_matrix(serial).unwrap();
        assert_eq!(read(&drawn).unwrap(), serial.as_bytes());
    }

    #[test]
    fn a_chinese_text_is_marked_as_utf_8() {
        let serial = "批次7-000017";
        let drawn = read(&data_matrix(serial).unwrap());
        let marked = DecodingError::DataDecoding(DataDecodingError::ECICode);
        assert_eq!(drawn, Err(marked), "this reader takes no marked text");
        let symbol = DataMatrix::encode_str(serial, SymbolList::default()).unwrap();
        assert_eq!(decode_str(symbol.data_codewords()).unwrap(), serial);
    }
}
