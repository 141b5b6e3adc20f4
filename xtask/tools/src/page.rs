//! Tables and code spans of a page of the book.

/// A table: its header, and its rows.
pub(crate) struct Table<'a> {
    header: Row<'a>,
    pub(crate) rows: Vec<Row<'a>>,
}

impl<'a> Table<'a> {
    /// The number of the column with this header.
    pub(crate) fn column(&self, name: &str) -> Option<usize> {
        self.header.0.iter().position(|cell| *cell == name)
    }

    /// The code spans of a cell of the header.
    pub(crate) fn spans(&self, column: usize) -> Vec<&'a str> {
        self.header.spans(column)
    }
}

/// The cells of a line, without the blanks around them.
pub(crate) struct Row<'a>(Vec<&'a str>);

impl<'a> Row<'a> {
    fn of(line: &'a str) -> Option<Self> {
        let line = line.trim().strip_prefix('|')?;
        let line = line.strip_suffix('|').unwrap_or(line);
        let mut cells = Vec::new();
        let mut begin = 0;
        for (at, _) in line.match_indices('|') {
            if !line[..at].ends_with('\\') {
                cells.push(line[begin..at].trim());
                begin = at + 1;
            }
        }
        cells.push(line[begin..].trim());
        Some(Self(cells))
    }

    /// The text of a cell; empty if the row has fewer cells.
    pub(crate) fn cell(&self, column: usize) -> &'a str {
        self.0.get(column).copied().unwrap_or_default()
    }

    /// The code spans of a cell; none if the row has fewer cells.
    pub(crate) fn spans(&self, column: usize) -> Vec<&'a str> {
        spans(self.cell(column))
    }
}

/// Text between backticks.
fn spans(text: &str) -> Vec<&str> {
    text.split('`').skip(1).step_by(2).collect()
}

/// The tables of a page, except tables in its programs.
pub(crate) fn tables(page: &str) -> Vec<Table<'_>> {
    let mut tables: Vec<Table<'_>> = Vec::new();
    let mut before = None;
    let mut is_open = false;
    for line in prose(page) {
        let row = Row::of(line);
        let is_rule = line.starts_with("|--") || line.starts_with("| --");
        match (row, before.take()) {
            (Some(_), Some(header)) if is_rule && !is_open => {
                let rows = Vec::new();
                tables.push(Table { header, rows });
                is_open = true;
            }
            (Some(row), _) if is_open => {
                if let Some(table) = tables.last_mut() {
                    table.rows.push(row);
                }
            }
            (row, _) => {
                before = row;
                is_open = false;
            }
        }
    }
    tables
}

/// The lines outside fenced blocks.
pub(crate) fn prose(page: &str) -> impl Iterator<Item = &str> {
    let mut is_program = false;
    page.lines().filter(move |line| {
        let is_fence = line.trim_start().starts_with("```");
        is_program ^= is_fence;
        !is_program && !is_fence
    })
}

/// The lines inside fenced blocks.
pub(crate) fn blocks(page: &str) -> impl Iterator<Item = &str> {
    let mut is_program = false;
    page.lines().filter(move |line| {
        let is_fence = line.trim_start().starts_with("```");
        is_program ^= is_fence;
        is_program && !is_fence
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_cut_into_cells_and_programs_are_none() {
        let page =
            "| a | b |\n|---|---|\n| `x`, `y\\|z` | c |\n\n```text\n| d |\n|---|\n| e |\n```\n";
        let tables = tables(page);
        assert_eq!(tables.len(), 1);
        assert_eq!(tables[0].column("b"), Some(1));
        assert_eq!(tables[0].rows[0].spans(0), ["x", "y\\|z"]);
        assert_eq!(tables[0].rows[0].spans(1), Vec::<&str>::new());
        assert_eq!(tables[0].rows[0].cell(1), "c");
    }
}
