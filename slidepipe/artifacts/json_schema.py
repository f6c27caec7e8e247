"""Documents as JSON Schema (2020-12), for editors and for programs that are not ours."""

from slidepipe.artifacts.documents import DOCUMENTS
from slidepipe.artifacts.wording import one_of
from slidepipe.errors import NotFoundError


def names() -> dict[str, dict[str, str]]:
    """Documents by name, each with its ``schema`` header and ``what`` it is."""
    return {
        name: {
            "schema": f"{model.SCHEMA}/{model.VERSION}",
            "what": (model.__doc__ or "").splitlines()[0].replace("``", ""),
        }
        for name, model in DOCUMENTS.items()
    }


def json_schema(name: str) -> dict[str, object]:
    """JSON Schema of a document; what depends on several values at once stands in no schema.

    Raises
    ------
    NotFoundError
        There is no such document.
    """
    model = DOCUMENTS.get(name)
    if model is None:
        raise NotFoundError(f"schema {name}: no such document, there are {one_of(list(DOCUMENTS), len(DOCUMENTS))}")
    made = model.model_json_schema()
    header = f"{model.SCHEMA}/{model.VERSION}"
    described = {"const": header, "description": "Kind and version of the document."}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **made,
        "title": header,
        "properties": {"schema": described, **made.get("properties", {})},
        "required": ["schema", *made.get("required", [])],
    }
