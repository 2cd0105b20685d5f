"""``python -m sceneql``: the program, where its script is not on the path."""

from sceneql.cli import main

if __name__ == "__main__":
    main()
