//! Where panels, captions and color bars go.

use crate::{ColorBars, Columns, Error, Paint, Panel, RenderOptions};

/// Pixels from the upper left: x, y, width, height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rect {
    pub(crate) x: u32,
    pub(crate) y: u32,
    pub(crate) width: u32,
    pub(crate) height: u32,
}

/// The parts of a panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cell {
    /// All of it, color bar and caption included.
    pub(crate) whole: Rect,
    /// Where models are drawn.
    pub(crate) view: Rect,
    /// The height of capital letters.
    pub(crate) text: f64,
}

/// A cell for each panel.
pub(crate) fn cells(panels: &[Panel<'_>], options: &RenderOptions) -> Result<Vec<Cell>, Error> {
    let (width, height) = (options.width, options.height);
    let count = u32::try_from(panels.len()).unwrap_or(u32::MAX);
    let columns = match options.columns {
        Columns::Count(columns) => columns.min(count.max(1)),
        Columns::Auto => best_columns(count, width, height),
    };
    let rows = count.div_ceil(columns);
    let error = Error::PanelsDoNotFit { panels: panels.len(), width, height };
    if columns > width || rows > height {
        return Err(error);
    }
    let cell = |i: usize| {
        let (i, columns, rows) = (i as u64, u64::from(columns), u64::from(rows));
        let edge = |k: u64, of: u64, side: u32| (u64::from(side) * k / of) as u32;
        let (column, row) = (i % columns, i / columns);
        let (x, y) = (edge(column, columns, width), edge(row, rows, height));
        let right = edge(column + 1, columns, width);
        let bottom = edge(row + 1, rows, height);
        let whole = Rect { x, y, width: right - x, height: bottom - y };
        let text = text_height(&whole);
        let mut view = whole;
        if !panels[i as usize].caption.is_empty() {
            let band = (3.0 * text) as u32;
            view.height = view.height.checked_sub(band).filter(|&h| h > 0)?;
        }
        if options.color_bars == ColorBars::Shown && has_scalars(&panels[i as usize]) {
            view.width = view.width.checked_sub(bar_width(text)).filter(|&w| w > 0)?;
        }
        Some(Cell { whole, view, text })
    };
    (0..panels.len()).map(cell).collect::<Option<Vec<Cell>>>().ok_or(error)
}

/// Letters grow slower than panels do, and are never too small to read.
fn text_height(panel: &Rect) -> f64 {
    (0.5 * f64::from(panel.width.min(panel.height)).sqrt()).clamp(7.0, 48.0).round()
}

/// What a color bar with its labels takes.
fn bar_width(text: f64) -> u32 {
    (9.5 * text) as u32
}

pub(crate) fn has_scalars(panel: &Panel<'_>) -> bool {
    panel.models.iter().any(|model| matches!(model.style.paint, Paint::Scalars(_)))
}

/// The number of columns that makes the shorter side of a panel longest; of equals the one with the
/// fewest empty places.
fn best_columns(count: u32, width: u32, height: u32) -> u32 {
    let size = |columns: u32| {
        let rows = count.div_ceil(columns);
        let side = (f64::from(width) / f64::from(columns)).min(f64::from(height) / f64::from(rows));
        (side, u64::from(columns) * u64::from(rows))
    };
    let mut best = 1;
    for columns in 2..=count.min(width) {
        let ((side, places), (best_side, best_places)) = (size(columns), size(best));
        if side > best_side || (side == best_side && places < best_places) {
            best = columns;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_are_as_large_as_they_can_be() {
        let columns = |count| best_columns(count, 1200, 900);
        assert_eq!([1, 2, 3, 4, 6, 12].map(columns), [1, 2, 2, 2, 3, 4]);
        assert_eq!(best_columns(4, 4000, 500), 4);
        assert_eq!(best_columns(0, 100, 100), 1);
    }

    #[test]
    fn cells_cover_the_picture() {
        let panels = vec![Panel::default(); 5];
        let options = RenderOptions { width: 101, height: 67, ..RenderOptions::default() };
        let cells = cells(&panels, &options).unwrap();
        let area: u32 = cells.iter().map(|cell| cell.whole.width * cell.whole.height).sum();
        let places = cells.len().next_multiple_of(3) as u32;
        assert!(area <= 101 * 67 && area * places > 101 * 67 * 4, "{cells:?}");
    }

    #[test]
    fn too_many_panels_are_refused() {
        let panels = vec![Panel { caption: "x".into(), ..Panel::default() }; 200];
        let options = RenderOptions { width: 60, height: 60, ..RenderOptions::default() };
        assert!(matches!(cells(&panels, &options), Err(Error::PanelsDoNotFit { panels: 200, .. })));
    }
}
