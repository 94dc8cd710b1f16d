"""The works that the report cites, by their keys in references.bib."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["SOURCES", "Source"]


@dataclass(frozen=True)
class Source:
    """A reference: authors, year, title, where it appeared, DOI."""

    authors: str
    year: int
    title: str
    where: str
    doi: str = ""

    @property
    def short(self) -> str:
        """As it is cited in a text: Walter et al. 2007."""
        names = [author.split()[-1] for author in self.authors.split(", ")]
        who = f"{names[0]} et al." if len(names) > 2 else " and ".join(names)
        return f"{who} {self.year}"


SOURCES = {
    "beckmann1963scattering": Source(
        "P. Beckmann, A. Spizzichino",
        1963,
        "The Scattering of Electromagnetic Waves from Rough Surfaces",
        "Pergamon Press",
    ),
    "burley2012disney": Source(
        "B. Burley", 2012, "Physically-Based Shading at Disney", "ACM SIGGRAPH 2012 Courses"
    ),
    "deon2020hitchhiker": Source(
        "E. d’Eon",
        2020,
        "A Hitchhiker’s Guide to Multiple Scattering",
        "with Mathematica notebooks, one for each distribution",
    ),
    "deon2023student": Source(
        "E. d’Eon",
        2023,
        "Student-T and Beyond: Practical Tools for Multiple-Scattering BSDFs with General NDFs",
        "ACM SIGGRAPH 2023 Talks",
    ),
    "heitz2014masking": Source(
        "E. Heitz",
        2014,
        "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs",
        "Journal of Computer Graphics Techniques 3(2)",
    ),
    "heitz2016multiple": Source(
        "E. Heitz, J. Hanika, E. d’Eon, C. Dachsbacher",
        2016,
        "Multiple-Scattering Microfacet BSDFs with the Smith Model",
        "ACM Transactions on Graphics 35(4)",
        "10.1145/2897824.2925943",
    ),
    "ribardiere2017std": Source(
        "M. Ribardière, B. Bringier, D. Meneveaux, L. Simonot",
        2017,
        "STD: Student’s t-Distribution of Slopes for Microfacet Based BSDFs",
        "Computer Graphics Forum 36(2)",
        "10.1111/cgf.13137",
    ),
    "smith1967shadowing": Source(
        "B. G. Smith",
        1967,
        "Geometrical Shadowing of a Random Rough Surface",
        "IEEE Transactions on Antennas and Propagation 15(5)",
        "10.1109/TAP.1967.1138991",
    ),
    "trowbridge1975average": Source(
        "T. S. Trowbridge, K. P. Reitz",
        1975,
        "Average Irregularity Representation of a Rough Surface for Ray Reflection",
        "Journal of the Optical Society of America 65(5)",
        "10.1364/JOSA.65.000531",
    ),
    "walter2007microfacet": Source(
        "B. Walter, S. R. Marschner, H. Li, K. E. Torrance",
        2007,
        "Microfacet Models for Refraction through Rough Surfaces",
        "Rendering Techniques 2007",
        "10.2312/EGWR/EGSR07/195-206",
    ),
}
