//! Tables and code of a page.

use pulldown_cmark::{CodeBlockKind, Event, Options, Parser, Tag, TagEnd};

/// The content of a page, in its order.
#[derive(Debug, Default)]
pub(crate) struct Page {
    pub(crate) tables: Vec<Table>,
    /// The code in its text.
    pub(crate) spans: Vec<String>,
    /// Blocks of code, each with the words after its fence.
    pub(crate) blocks: Vec<(String, String)>,
}

/// A table: its header and its rows.
#[derive(Debug, Default)]
pub(crate) struct Table {
    pub(crate) header: Vec<Cell>,
    pub(crate) rows: Vec<Vec<Cell>>,
}

/// A cell: its text, and the code in it.
#[derive(Debug, Default)]
pub(crate) struct Cell {
    pub(crate) text: String,
    pub(crate) spans: Vec<String>,
}

impl Page {
    pub(crate) fn parse(text: &str) -> Self {
        let mut page = Self::default();
        let mut row = Vec::new();
        let mut is_block = false;
        for event in Parser::new_ext(text, Options::ENABLE_TABLES) {
            let (table, cell) = (page.tables.last_mut(), row.last_mut());
            match (event, table, cell) {
                (Event::Start(Tag::Table(_)), ..) => page.tables.push(Table::default()),
                (Event::Start(Tag::TableCell), ..) => row.push(Cell::default()),
                (Event::End(TagEnd::TableHead), Some(table), _) => table.header.append(&mut row),
                (Event::End(TagEnd::TableRow), Some(table), _) => table.rows.push(row.split_off(0)),
                (Event::Start(Tag::CodeBlock(kind)), ..) => {
                    is_block = true;
                    let info = match kind {
                        CodeBlockKind::Fenced(info) => info.to_string(),
                        CodeBlockKind::Indented => String::new(),
                    };
                    page.blocks.push((info, String::new()));
                }
                (Event::End(TagEnd::CodeBlock), ..) => is_block = false,
                (Event::Text(text), ..) if is_block => {
                    page.blocks.iter_mut().last().unwrap().1 += &text
                }
                (Event::Text(text), _, Some(cell)) => cell.text += &text,
                (Event::Code(code), _, cell) => {
                    cell.into_iter()
                        .for_each(|cell| cell.spans.push(code.to_string()));
                    page.spans.push(code.into_string());
                }
                _ => {}
            }
        }
        page
    }
}

impl Table {
    /// The number of the column with this header.
    pub(crate) fn column(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|cell| cell.text == name)
    }

    /// The code in the first column.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        let cells = self.rows.iter().filter_map(|row| row.first());
        cells.flat_map(|cell| cell.spans.iter().map(String::as_str))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_cut_into_cells_and_programs_are_none() {
        let page = Page::parse(
            "| a | b |\n|---|---|\n| `x`, `y\\|z` | c |\n\n```text\n| d |\n|---|\n| e |\n```\n",
        );
        let [table] = &page.tables[..] else {
            panic!("{page:?}");
        };
        assert_eq!(table.column("b"), Some(1));
        assert_eq!(table.names().collect::<Vec<_>>(), ["x", "y|z"]);
        assert_eq!(
            (&*table.rows[0][1].text, table.rows[0][1].spans.len()),
            ("c", 0)
        );
        let block = ("text".to_owned(), "| d |\n|---|\n| e |\n".to_owned());
        assert_eq!(page.blocks, [block]);
    }
}
