"""nbgrader in this folder: its own commands, with the course's judgement, isolation and notebooks.

    nbgrader generate_assignment sphere_tracing     release/, from solutions/
    nbgrader autograde sphere_tracing               autograded/, from submitted/STUDENT/sphere_tracing/
    nbgrader generate_feedback sphere_tracing       feedback/
"""

from autograder.nbgrader_plugin import configure

c = get_config()  # noqa: F821  nbgrader puts it here
configure(c)

# c.Judge.secret_file = "secret.txt"      # seeds the inputs that students do not see, as `course grade --secret` does
# c.CourseDirectory.db_url = "sqlite:///gradebook.db"
