"""Every link and picture of a built site, followed; and that it needs no network."""

from html.parser import HTMLParser
from urllib.parse import unquote, urlsplit

LOADED = {("script", "src"), ("img", "src"), ("link", "href"), ("iframe", "src"), ("source", "src")}
NOT_LOADED = {"canonical", "next", "prev", "index", "search", "author"}


class _Page(HTMLParser):
    """What a page links to, what it loads, and the places in it that can be linked to."""

    def __init__(self, text):
        super().__init__()
        self.links, self.loaded, self.places = [], [], {"", "top"}
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        self.places |= {found[key] for key in ("id", "name") if found.get(key)}
        for key in ("href", "src"):
            if found.get(key) and not found[key].startswith("data:"):
                self.links.append(found[key])
                if (tag, key) in LOADED and not NOT_LOADED & set((found.get("rel") or "").split()):
                    self.loaded.append(found[key])


def problems(folder):
    """What is wrong with the links of a site.

    Parameters
    ----------
    folder : Path       with its pages

    Returns
    -------
    list of str         a sentence each
    """
    pages = {path.resolve(): _Page(path.read_text(encoding="utf-8")) for path in sorted(folder.rglob("*.html"))}
    found = []
    for path, page in pages.items():
        where = path.relative_to(folder.resolve()).as_posix()
        found += [f"{where} loads {url} from the network" for url in page.loaded if urlsplit(url).scheme]
        for url in page.links:
            parts = urlsplit(url)
            if parts.scheme in ("http", "https", "mailto"):
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not target.is_file():
                found.append(f"{where} links to {url}, which is not there")
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].places:
                found.append(f"{where} links to {url}: the page has no such place")
    return found
