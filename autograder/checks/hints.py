"""Three steps towards each task: a question, an idea, and almost the line."""

HINTS = {
    "1.1": (
        "Stand outside a ball. Which length do you have to walk to its centre, and which part of it lies inside?",
        "The distance to a surface that surrounds a point is the distance to that point less how far the surface is from it.",
        "Take the length of p - center over the last axis, so that one point, a list and a grid all work; one subtraction "
        "is left, and its sign is right inside by itself.",
    ),
    "1.2": (
        "Fold the box onto the corner where all coordinates are positive. How far does the point stick out along each axis?",
        "Outside, negative excesses count as 0 and the rest is a length. Inside, all three are negative: the largest of "
        "them says how far the nearest face is.",
        "With q = |p - center| - half_size: the length of q clamped from below at 0, plus the largest component of q "
        "clamped from above at 0. Only one of the two terms is ever not 0.",
    ),
    "1.3": (
        "A torus is all points at one distance from a circle. How far is a point from that circle?",
        "Look at the half plane through the axis: the circle is one point in it. Its two coordinates there are the way "
        "from the axis, and the height.",
        "The way from the axis is hypot of x and z; less major_radius, it is one leg of a right triangle whose other leg "
        "is y. The hypotenuse leads to the middle of the tube.",
    ),
    "1.4": (
        "What should be left of the second distance at t = 0, and of the first at t = 1?",
        "Each distance has a weight that is linear in t, and the two weights add up to 1 whatever t is.",
        "One weight is t itself, the other is what is missing to 1. Write no `if`: t may be an array.",
    ),
    "1.5": (
        "By how much must the result be below min(d1, d2) where both are equal, and where they differ by k or more?",
        "The term that is subtracted falls from k / 4 to 0 as |d1 - d2| grows from 0 to k, and meets 0 without a kink: "
        "a square does.",
        "Let h be k - |d1 - d2|, but never below 0. The quotient of its square and a multiple of k is what to subtract; "
        "at h = k it must be k / 4.",
    ),
    "1.6": (
        "If you take a small step along x, what does the change of the distance tell you about the normal's x?",
        "The three changes along the three axes, each measured from both sides, point like the gradient. Its length is "
        "not yet 1.",
        "Ask sdf at p + eps e and p - eps e for each unit vector e, put the three differences side by side on the last "
        "axis, and normalise each row for itself.",
    ),
    "1.7": (
        "At a point with distance h to everything, how far may the ray go without a look?",
        "Keep t for each ray and the list of rays that still march. Evaluate, test for a hit, only then step; a ray "
        "leaves the list when it has hit or is beyond t_max.",
        "In each of max_steps rounds: h = sdf at origin + t direction of the marching rays; where h < eps, t is the "
        "answer; the others step by h and stay while t <= t_max. What never hit keeps inf.",
    ),
    "2.1": (
        "A ball around the point on the ray touches nothing. Under which angle does the start of the ray see it?",
        "The tangent, the radius and the way travelled form a right triangle: the radius is opposite to the angle, the "
        "way is the hypotenuse.",
        "arcsin of distance / travelled, between its two ends: decide first where the answer is 0 and where it is pi / 2, "
        "and divide by something harmless there.",
    ),
    "2.2": (
        "For which ratio of distance and way is exactly all of the light visible?",
        "Visibility grows in proportion to distance / travelled, with the slope k, and stops at 1.",
        "The smaller of 1 and k distance / travelled; 0 where the distance is 0 or less, and 1 where nothing has been "
        "travelled yet. Choose these cases before you divide.",
    ),
    "2.3": (
        "For which points do you know without any ray that the light cannot be seen?",
        "The sign of the cosine between normal and light tells on which side of the horizon the light stands.",
        "Sum the products over the last axis and compare with 0: exactly on the horizon there is no light. One light "
        "(3,) for all normals needs nothing extra if you multiply by broadcasting.",
    ),
    "2.4": (
        "Which point of the whole ray decides how dark the penumbra is: the first, the last, or another?",
        "March as in 1.7, but from t_min, and keep for each ray the smallest penumbra over all points that it visits.",
        "In each round: h = sdf at the marching points, seen = min(seen, penumbra(h, t, k)), and 0 where h < 1e-4; then "
        "step by h. Blocked rays leave the list, and those beyond t_max do.",
    ),
    "2.5": (
        "A light is half hidden when the edge runs through its middle. Which sign has the angle to the edge on either side?",
        "Let the march go on inside, where the distance is negative, and keep the smallest signed angle: from one radius "
        "of the light (all seen) to minus one (all hidden).",
        "Let x be arcsin(distance / travelled) / angular_radius at its smallest, cut to [-1, 1]; step by |distance|, but "
        "never by much less than the light's width there. The seen part of a disc cut at x is a segment's area.",
    ),
    "3.1": (
        "Which of the two random numbers decides how far a facet is tilted, and which way it is turned?",
        "Find the share of facets that are tilted less than theta: the integral of D cos over them. Set it equal to a "
        "random number and solve for theta.",
        "tan(theta) is alpha times the root of u / (1 - u), phi is a full turn times the other number. From the tangent, "
        "sine and cosine follow without cancelling.",
    ),
    "3.2": (
        "Which pixels of the sky does a surface with this normal see, and which of them count most?",
        "It is a weighted mean over all pixels: the weight is the cosine, 0 below the horizon, times the pixel's solid "
        "angle.",
        "All cosines at once are one matrix product of the normals and env.directions(). Clamp at 0, multiply by "
        "env.solid_angles(), and divide the weighted sum of colours by the sum of the weights.",
    ),
    "3.3": (
        "Where does a mirror of normal n look when the view is along n, and how does roughness spread that?",
        "Draw half vectors about n with sample_ggx, reflect the view at each, look the map up there, and weigh by n.l.",
        "With v = n: l = 2 (n.h) h - n. Turn the samples into the frame of each pixel's direction, drop l below the "
        "horizon, and divide by the sum of the weights. At alpha = 0 look up and return.",
    ),
    "3.4": (
        "What does filtering a map that is already filtered give?",
        "Each level needs its own width and its own height, and the unfiltered environment.",
        "One call of prefilter for each pair of roughness and height, in the given order; its second argument is alpha, "
        "not roughness.",
    ),
    "3.5": (
        "Between which two levels does a roughness lie, and how far along the way from one to the other?",
        "The levels are uneven: np.interp of the roughness over roughness_levels gives a position in the chain, and stops "
        "at the ends.",
        "The whole part of the position is the first level, the rest t. Look both maps up with fw.Environment(...).radiance "
        "and mix them with 1 - t and t; at the last level there is no next one.",
    ),
    "3.6": (
        "If f were constant, which sum would remain?",
        "Outside of g's support f must not count at all: choose the samples there first, then take the mean of f over them.",
        "Both sums of the mean run over g != 0 and carry the weights; the second factor is the weighted sum of g. Take "
        "care of a support without any sample.",
    ),
    "4.1": (
        "Which values do you know without any formula: straight on, and at a right angle?",
        "Between r0 and 1 the rest, 1 - r0, comes in with the fifth power of 1 - cos_theta. r0 itself is an amplitude "
        "squared.",
        "r0 plus what is missing to 1, times a power that is 1 at cos_theta = 0 and 0 at cos_theta = 1. For r0_from_ior: "
        "difference over sum of the indices, then square the quotient.",
    ),
    "4.2": (
        "What must the integral of D times the cosine over the hemisphere be, whatever alpha is?",
        "Both depend on tan^2 / alpha^2 alone: Beckmann by an exponential, GGX by the square of 1 over 1 + that. In front "
        "stands 1 / (pi alpha^2 cos^4), which turns a density of slopes into one per steradian.",
        "Multiply GGX's cos^4 into its bracket: cos^2 alpha^2 + sin^2, squared, times pi, below alpha^2. Write sin^2 as "
        "(1 - c)(1 + c), and 0 where c is 0 or less.",
    ),
    "4.3": (
        "What part of the facets is hidden when you look straight down, and what part at grazing angles?",
        "Lambda is (sqrt(1 + alpha^2 tan^2) - 1) / 2 for each direction. Correlated heights add the two Lambdas; "
        "multiplying two G1 would count what hides both twice.",
        "1 over 1 + Lambda_i + Lambda_o; the halves and ones cancel to 2 over the sum of two roots. 0 where either cosine "
        "is at or below 0.",
    ),
    "4.4": (
        "Which facets can send light from to_light to view, and at which angle does the light meet them?",
        "The half vector has three cosines: n.h for D, v.h for Fresnel, while n.i and n.o are for G and for the "
        "denominator.",
        "D(n.h) G(n.i, n.o) / (4 n.i n.o), where both cosines are positive, else 0; then times fresnel_schlick(r0, v.h) "
        "with an axis for the colour.",
    ),
    "4.5": (
        "For one direction of light, what does the rendering equation multiply, and what does sampling divide by?",
        "Average f L cos / density over directions. Whatever you draw by, the density must be per solid angle of the "
        "light; half vectors drawn by D n.h need the factor 1 / (4 v.h).",
        "With half vectors from fw.sample_ggx, D cancels: F G (v.h) / ((n.o)(n.h)) times the radiance along l. Draw from "
        "rng alone, count samples below the horizon as 0, and divide by the number of samples, not of those that counted.",
    ),
    "4.6": (
        "If the sky is white, which part of the reflected light is proportional to r0, and which is not?",
        "Put F = r0 (1 - s) + s, with s the fifth power at v.h, into the estimator of 4.5: two means over the same "
        "samples, one with 1 - s and one with s.",
        "For each row alpha = roughness^2, for each column a view with that cosine: weight = G (v.h) / ((n.v)(n.h)), 0 "
        "where l is below. The cell centres are (i + 0.5) / size.",
    ),
    "4.7": (
        "Where on the axis from 0 to 1 does the entry number i of a table lie?",
        "Position = x size - 0.5, cut to what the table has; its whole part is one neighbour, the next is the other, and "
        "the rest is the weight.",
        "Roughness chooses two rows, the cosine two columns, both by the same few lines. Mix along one axis, then along "
        "the other; the weights need an axis more, for scale and bias.",
    ),
    "4.8": (
        "Which two look-ups does a pixel need, and with which direction, cosine and roughness?",
        "The filtered sky is asked along the mirrored view, the table at n.v. Fresnel is in the table already: r0 stays "
        "what it is.",
        "prefiltered(2 (n.v) n - v, roughness) times (r0 scale + bias), for the points with n.v > 0 alone; the rest "
        "stay 0. Mind the axis that r0 and the table's values need for colours.",
    ),
    "5.1": (
        "If you may cut the sky in two once, where do you cut, so that both lights are equally strong?",
        "Again and again, cut the region with the most energy, across its longer side, where half of its energy is on "
        "either side. Energy is luminance times solid angle.",
        "cumsum of the energy along the longer side, nearest to half of the total, is the cut. At the end: power is the "
        "sum of radiance times solid angle, the direction is the energy-weighted sum of directions, normalised.",
    ),
    "5.2": (
        "How can a few directions stand for a hemisphere in which low directions count less?",
        "Points that are even on the unit disc, lifted onto the hemisphere, are distributed by the cosine. Each stands "
        "for a cone; how much of it is seen is told by 2.5's signed angle.",
        "Turn the local directions into the frame of each normal, march them all together up to t_max from a little "
        "above the surface, make of the smallest angle over the cone's a fraction, and take the plain mean over the cones.",
    ),
    "5.3": (
        "Which of the two parts is darkened by what, and where is the view without any meaning?",
        "Matt: albedo times light.irradiance, times the part of dominant_lights' light that gets through. Glossy: the "
        "split sum, times how much of the lobe about the mirror direction is free.",
        "March towards each light that is above the horizon, as wide as its solid angle, and weigh with power times "
        "cosine: what gets through over what would. For the lobe, one march along the mirror direction is enough.",
    ),
}  # fmt: skip
