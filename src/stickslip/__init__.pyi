# The public names of stickslip: the one list, read by type checkers and by the lazy import of __init__.py.
from .case.case import Case as Case
from .case.case import load_case as load_case
from .contact.law.contact_pairs import ContactPairs as ContactPairs
from .contact.law.coulomb import contact_cycle as contact_cycle
from .contact.law.normal_law import PressureGapLaw as PressureGapLaw
from .contact.pairing.pairing import pair_faces as pair_faces
from .contact.pairing.pairing import pair_surfaces as pair_surfaces
from .contact.pairing.pairing import pair_with_ground as pair_with_ground
from .contact.stiffness.fractal import Roughness as Roughness
from .contact.stiffness.fractal import contact_stiffness as contact_stiffness
from .contact.stiffness.roughness_fit import RoughnessFit as RoughnessFit
from .contact.stiffness.roughness_fit import fit_roughness as fit_roughness
from .contact.stiffness.surface import fractal_surface as fractal_surface
from .formats.calculix_deck import write_calculix_deck as write_calculix_deck
from .formats.matrices.exchange import read_superelement as read_superelement
from .formats.matrices.exchange import write_superelement as write_superelement
from .formats.matrices.model import MatrixModel as MatrixModel
from .formats.matrices.read import read_matrices as read_matrices
from .formats.matrices.reduce import reduce_matrices as reduce_matrices
from .results.response import ForcedResponse as ForcedResponse
from .solve.forced import forced_response as forced_response
from .solve.static.ramp_to_rest import static_preload as static_preload
from .solve.static.state import StaticState as StaticState
from .structure.craig_bampton import craig_bampton as craig_bampton
from .structure.elasticity import Material as Material
from .structure.elasticity import Structure as Structure
from .structure.elasticity import assemble as assemble
from .structure.mesh import Mesh as Mesh
from .structure.superelement import Superelement as Superelement
from .study.run import report as report
from .study.run import run as run
from .sweeps.run import sweep as sweep

__version__: str
