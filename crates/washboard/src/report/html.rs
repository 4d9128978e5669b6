//! Markup that is escaped by construction: text becomes [`Html`] only through its escape.

use serde::Serialize;

/// A piece of well-formed markup.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Html(String);

impl Html {
    /// Markup of our own, which has no need of escape: a constant, so never a name from a file.
    pub fn own(markup: &'static str) -> Self {
        Html(markup.to_owned())
    }

    /// Another piece after this one.
    pub fn push(&mut self, piece: impl Into<Html>) {
        self.0.push_str(&piece.into().0);
    }

    /// The same, as a value.
    pub fn and(mut self, piece: impl Into<Html>) -> Self {
        self.push(piece);
        self
    }

    /// The markup.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl From<&str> for Html {
    fn from(text: &str) -> Self {
        let mut escaped = String::with_capacity(text.len());
        for c in text.chars() {
            match c {
                '&' => escaped.push_str("&amp;"),
                '<' => escaped.push_str("&lt;"),
                '>' => escaped.push_str("&gt;"),
                '"' => escaped.push_str("&quot;"),
                '\'' => escaped.push_str("&#39;"),
                // no XML and no terminal wants the others
                c if c.is_control() && c != '\n' && c != '\t' => escaped.push('\u{fffd}'),
                c => escaped.push(c),
            }
        }
        Html(escaped)
    }
}

impl From<String> for Html {
    fn from(text: String) -> Self {
        Html::from(text.as_str())
    }
}

impl<const N: usize> From<[Html; N]> for Html {
    fn from(pieces: [Html; N]) -> Self {
        pieces.into_iter().collect()
    }
}

impl FromIterator<Html> for Html {
    fn from_iter<I: IntoIterator<Item = Html>>(pieces: I) -> Self {
        let mut all = Html::default();
        for piece in pieces {
            all.push(piece);
        }
        all
    }
}

/// An element with attributes; their values and text inside are escaped.
pub(super) fn element(
    tag: &'static str,
    attributes: &[(&'static str, &str)],
    inside: impl Into<Html>,
) -> Html {
    let mut out = format!("<{tag}");
    for (name, value) in attributes {
        out.push_str(&format!(" {name}=\"{}\"", Html::from(*value).0));
    }
    Html(format!("{out}>{}</{tag}>", inside.into().0))
}

/// A meta element, which has no end.
pub(super) fn meta(attributes: &[(&'static str, &str)]) -> Html {
    let Html(whole) = element("meta", attributes, "");
    Html(whole.replace("</meta>", ""))
}

/// An element with a class, or with none where that is empty.
pub(super) fn classed(tag: &'static str, class: &str, inside: impl Into<Html>) -> Html {
    if class.is_empty() { element(tag, &[], inside) } else { element(tag, &[("class", class)], inside) }
}

/// A paragraph.
pub(super) fn paragraph(inside: impl Into<Html>) -> Html {
    element("p", &[], inside)
}

/// A remark in smaller type.
pub(super) fn note(inside: impl Into<Html>) -> Html {
    classed("p", "note", inside)
}

/// A table that scrolls by itself where the page is narrow. A head that starts with `#` is of a column of numbers,
/// set to the right.
pub(super) fn table(caption: &str, heads: &[&str], rows: Vec<Vec<Html>>) -> Html {
    let class = |k: usize| if heads.get(k).is_some_and(|h| h.starts_with('#')) { "number" } else { "" };
    let head: Html = heads
        .iter()
        .enumerate()
        .map(|(k, h)| {
            let title = h.trim_start_matches('#').trim_start();
            let mut attributes = vec![("scope", "col")];
            if !class(k).is_empty() {
                attributes.push(("class", class(k)));
            }
            element("th", &attributes, title)
        })
        .collect();
    let body: Html = rows
        .into_iter()
        .map(|row| {
            let cells: Html =
                row.into_iter().enumerate().map(|(k, cell)| classed("td", class(k), cell)).collect();
            element("tr", &[], cells)
        })
        .collect();
    let caption = if caption.is_empty() { Html::default() } else { element("caption", &[], caption) };
    let inside =
        caption.and(element("thead", &[], element("tr", &[], head))).and(element("tbody", &[], body));
    classed("div", "scroll", element("table", &[], inside))
}

/// Data in a script element that no browser runs: JSON in which nothing can end the element or start another.
pub(super) fn json_script(id: &str, data: &impl Serialize) -> Html {
    // plain structs of numbers and texts: there is nothing that serde_json could refuse
    let json = serde_json::to_string(data).unwrap_or_else(|_| "null".to_owned());
    let mut safe = String::with_capacity(json.len());
    for c in json.chars() {
        match c {
            '<' | '>' | '&' | '\u{2028}' | '\u{2029}' => safe.push_str(&format!("\\u{:04x}", u32::from(c))),
            c => safe.push(c),
        }
    }
    let open = element("script", &[("type", "application/json"), ("id", id)], Html(safe));
    Html("\n".to_owned()).and(open)
}

/// A code element that the browser does obey: our own style or script.
pub(super) fn code(tag: &'static str, nonce: &str, source: &'static str) -> Html {
    element(tag, &[("nonce", nonce)], Html(format!("\n{source}\n")))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NASTY: &str = "</script><img src=x onerror=alert(1)> \"'& \u{2028}\u{2029} \u{7}";

    #[test]
    fn text_and_attributes_cannot_become_markup() {
        let html = element("td", &[("title", NASTY)], NASTY);
        assert_eq!(html.as_str().matches('<').count(), 2, "{html:?}");
        assert_eq!(html.as_str().matches('>').count(), 2, "{html:?}");
        assert_eq!(html.as_str().matches('"').count(), 2, "{html:?}");
        assert!(html.as_str().contains("&quot;&#39;&amp;") && !html.as_str().contains('\u{7}'));
    }

    #[test]
    fn json_is_read_back_equal_and_has_no_markup() {
        let data = vec![NASTY.to_owned(), "<!--".to_owned()];
        let html = json_script("data", &data);
        let inside = html.as_str().split_once('>').unwrap().1.rsplit_once("</script>").unwrap().0;
        assert!(!inside.contains(['<', '>', '&', '\u{2028}', '\u{2029}']), "{inside}");
        assert_eq!(serde_json::from_str::<Vec<String>>(inside).unwrap(), data);
    }

    #[test]
    fn numbers_stand_to_the_right() {
        let html = table("c", &["name", "# value"], vec![vec!["a<b".into(), "1".into()]]);
        assert!(html.as_str().contains("<th scope=\"col\" class=\"number\">value</th>"));
        assert!(html.as_str().contains("<td>a&lt;b</td><td class=\"number\">1</td>"));
    }
}
